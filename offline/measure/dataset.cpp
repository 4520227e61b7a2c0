// SPDX-License-Identifier: MIT
#include "offline/measure/dataset.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <unordered_map>

#include "offline/base/error.hpp"
#include "offline/base/read_file.hpp"
#include "offline/measure/columns.hpp"
#include "offline/measure/digest.hpp"
#include "offline/measure/rotation_columns.hpp"

namespace mdhcal::offline {

namespace {

constexpr std::size_t most_targets = 8;
constexpr std::size_t most_target_bytes = 15;

// Indices of words in their order of first appearance.
class Names {
 public:
  std::uint32_t index(std::string_view word, std::vector<std::string>& words) {
    // Rows of one group stand together, mostly.
    if (last_ < words.size() && words[last_] == word) return last_;
    const auto [entry, added] = index_.try_emplace(std::string(word), static_cast<std::uint32_t>(words.size()));
    if (added) words.emplace_back(word);
    return last_ = entry->second;
  }

 private:
  std::unordered_map<std::string, std::uint32_t> index_;
  std::uint32_t last_ = 0;
};

class Reader {
 public:
  Reader(const std::string& text, const std::string& path, const Robot& robot, const std::string& rotation,
         const std::function<void(std::size_t, std::size_t)>& progress)
      : progress_(progress),
        kilobytes_(text.size() / 1000),
        csv_(text, path, "a measurement file"),
        columns_(csv_),
        robot_(robot),
        rotation_named_(rotation) {
    data_.path = path;
    data_.joint_count = static_cast<std::size_t>(robot.geometry.joint_count);
    data_.digest_sha256 = sha256_hex(text);
  }

  Dataset read() {
    find_columns();
    while (csv_.next()) {
      read_row();
      if (progress_ && seen_ % 4096 == 0) progress_(csv_.position() / 1000, kilobytes_);
    }
    link_distances();
    add_notes();
    if (data_.rows.empty()) {
      throw InputError(csv_.path(), csv_.line(), 1,
                       seen_ == 0 ? "Found no row under the header; expected a row a measured target."
                                  : "Found no measured point in any of the " + std::to_string(seen_) +
                                        " rows (all are 0, 0, 0 or empty); expected at least one.");
    }
    return std::move(data_);
  }

 private:
  void find_columns() {
    const Unit length = length_unit(robot_);
    const Unit angle = angle_unit(robot_);
    // A quaternion in q1 ... q4 is told from joint readings first.
    rotation_.emplace(csv_, columns_, angle, rotation_named_);
    data_.rotation = {rotation_->convention(), rotation_->by_axis(), rotation_->unit_stated()};
    const std::vector<std::string> names(robot_.joint_name.begin(), robot_.joint_name.end());
    q_ = columns_.joints(robot_.geometry, angle, length, "q", "", true, names);
    for (const Column& column : q_) {
      data_.joint_columns.push_back(csv_.names()[column.index]);
      data_.angles_stated = data_.angles_stated || column.unit_stated;
    }
    commanded_ = columns_.joints(robot_.geometry, angle, length, "q", "_cmd", false, names);
    position_ = columns_.find_all({"x", "y", "z"}, length);
    distance_ = columns_.find("distance", length);
    to_ = columns_.find_text("to");
    data_.lengths_stated = position_.empty() ? distance_.unit_stated : position_.front().unit_stated;
    if (position_.empty() && !distance_) (void)columns_.require("x", length, "with the measured point (or \"distance\")");
    id_ = columns_.find_text("id");
    group_ = columns_.find_text("group");
    target_ = columns_.find_text("target");
    sigma_ = columns_.find("sigma", length);
    sigmas_ = columns_.find_all({"sx", "sy", "sz"}, length);
    sigma_rotation_ = columns_.find("sigma_rotation", angle);
    temperature_ = columns_.find_text("temperature");
    direction_ = columns_.find_text("direction");
    if (sigma_ && !sigmas_.empty()) csv_.fail_header(sigma_.index, "found beside sx, sy, sz; expected one of the two.");
    const std::string unknown = columns_.unknown();
    if (!unknown.empty()) data_.notes.push_back(csv_.path() + ": unknown columns are ignored: " + unknown + ".");
  }

  void read_row() {
    ++seen_;
    Measurement row;
    row.line = csv_.line();
    row.id = id_ && !id_.empty(csv_) ? std::string(csv_.field(id_.index)) : std::to_string(seen_);
    for (std::size_t j = 0; j < q_.size(); ++j) row.q[j] = q_[j].read(csv_, max_reading);
    const bool has_distance = distance_ && !distance_.empty(csv_);
    const bool has_position = read_position(row, has_distance);
    std::string_view to;
    if (has_distance) {
      to = read_distance(row, has_position);
    } else if (!has_position) {
      // It may be the other end of a distance; whether it is, is known at the end.
      pointless_.push_back(data_.rows.size());
    } else {
      read_rotation(row);
    }
    read_sigma(row);
    read_words(row);
    if (!to.empty()) links_.push_back({data_.rows.size(), std::string(to), row.line, csv_.column(to_.index)});
    data_.rows.push_back(std::move(row));
  }

  bool read_position(Measurement& row, bool has_distance) {
    if (position_.empty()) return false;
    std::size_t empty = 0;
    for (const Column& column : position_) empty += column.empty(csv_) ? 1U : 0U;
    if (empty == 3) return false;
    double size = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      row.position_m[k] = position_[k].read(csv_);
      size += std::abs(row.position_m[k]);
    }
    // Trackers export a lost point as 0, 0, 0; a draw wire's fixed end may well lie there, and a socket that is touched.
    if (!(size > 0) && !has_distance) at_origin_.push_back(data_.rows.size());
    return size > 0 || has_distance;
  }

  // The word in `to`, empty for a fixed end.
  std::string_view read_distance(Measurement& row, bool has_position) {
    row.kind = MeasurementKind::distance;
    row.distance_m = distance_.read(csv_);
    if (!(row.distance_m > 0)) {
      csv_.fail(distance_.index, "found " + std::string(csv_.field(distance_.index)) + "; expected a length above 0.");
    }
    const std::string_view to = to_ ? csv_.field(to_.index) : std::string_view{};
    if (to.empty() && !has_position) {
      csv_.fail(distance_.index, "found a distance to nothing; expected the other row's id in \"to\", or a fixed point "
                                 "in x, y, z.");
    }
    if (!to.empty() && has_position) {
      csv_.fail(to_.index, "found beside a point in x, y, z; expected the distance's other end once.");
    }
    return to;
  }

  void read_rotation(Measurement& row) {
    if (!rotation_->found() || rotation_->empty()) return;
    row.kind = MeasurementKind::pose;
    row.rotation_numbers = rotation_->numbers();
    row.quaternion = rotation_->quaternion(row.rotation_numbers);
  }

  void read_sigma(Measurement& row) {
    if (sigma_rotation_) row.sigma_rotation_rad = standard_deviation(sigma_rotation_);
    if (sigma_) row.sigma_m.fill(standard_deviation(sigma_));
    for (std::size_t k = 0; k < sigmas_.size(); ++k) row.sigma_m[k] = standard_deviation(sigmas_[k]);
  }

  // 0 where the field is empty.
  double standard_deviation(const Column& column) const {
    if (column.empty(csv_)) return 0.0;
    const double sd = column.read(csv_);
    if (sd < 0) {
      csv_.fail(column.index, "found " + std::string(csv_.field(column.index)) +
                                  "; expected a standard deviation, not below 0.");
    }
    return sd;
  }

  void read_words(Measurement& row) {
    const std::string_view target = target_ ? csv_.field(target_.index) : std::string_view{};
    if (target.size() > most_target_bytes) {
      csv_.fail(target_.index, "found a name of " + std::to_string(target.size()) + " bytes; expected at most " +
                                   std::to_string(most_target_bytes) + ".");
    }
    row.target = target_names_.index(target, data_.targets);
    if (data_.targets.size() > most_targets) {
      csv_.fail(target_.index, "found the " + std::to_string(most_targets + 1) + "th target \"" + std::string(target) +
                                   "\"; expected at most " + std::to_string(most_targets) + ".");
    }
    if (group_ && !group_.empty(csv_)) {
      row.group = group_names_.index(csv_.field(group_.index), data_.groups);
    } else if (target_ && id_) {
      // The reflectors of one pose are measured in one stand of the arm.
      row.group = group_names_.index(row.id, data_.groups);
    } else {
      row.group = static_cast<std::uint32_t>(data_.groups.size());
      data_.groups.push_back(row.id);
    }
    if (!commanded_.empty()) {
      auto& q = data_.commanded.emplace_back();
      for (std::size_t j = 0; j < commanded_.size(); ++j) q[j] = commanded_[j].read(csv_, max_reading);
    }
    if (temperature_) data_.temperature.push_back(temperature_.read(csv_));
    if (direction_) data_.direction.emplace_back(csv_.field(direction_.index));
  }

  // Finds the rows that `to` names, and drops the rows that measure nothing and are no distance's other end.
  void link_distances() {
    std::unordered_map<std::string, std::int64_t> by_id;
    constexpr std::int64_t ambiguous = -2;
    if (!links_.empty()) {
      const auto add = [&](const std::string& name, std::int64_t row) {
        const auto [entry, added] = by_id.try_emplace(name, row);
        if (!added && entry->second != row) entry->second = ambiguous;
      };
      for (std::size_t i = 0; i < data_.rows.size(); ++i) {
        const Measurement& row = data_.rows[i];
        add(row.id, static_cast<std::int64_t>(i));
        if (target_) add(row.id + '/' + data_.targets[row.target], static_cast<std::int64_t>(i));
      }
    }
    std::vector<bool> is_end(data_.rows.size(), false);
    for (const Link& link : links_) {
      const auto found = by_id.find(link.to);
      const bool own = found != by_id.end() && found->second == static_cast<std::int64_t>(link.row);
      if (found == by_id.end() || found->second == ambiguous || own) {
        throw InputError(csv_.path(), link.line, link.column,
                         "Column \"to\": found \"" + link.to + "\", which names " +
                             (own ? "the row itself" : found == by_id.end() ? "no row" : "more than one row") +
                             "; expected the id of one other row (or id/target).");
      }
      data_.rows[link.row].other_row = found->second;
      is_end[static_cast<std::size_t>(found->second)] = true;
    }
    keep_touched_origin();
    drop_pointless(is_end);
  }

  // Points that come back bit by bit at other joint readings are not what a tracker measured but what the arm touched:
  // where all of the others do, a point at 0, 0, 0 is one of them and not a lost one.
  void keep_touched_origin() {
    if (at_origin_.empty()) return;
    struct Touched {
      const Joints* first;
      bool again;
    };
    std::map<std::array<double, 3>, Touched> points;
    auto pointless = pointless_.begin();
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      if (pointless != pointless_.end() && *pointless == i) {
        ++pointless;
        continue;
      }
      const Measurement& row = data_.rows[i];
      if (row.kind == MeasurementKind::distance) return;
      Touched& point = points.try_emplace(row.position_m, Touched{&row.q, false}).first->second;
      point.again = point.again || row.q != *point.first;
    }
    if (points.empty() || !std::all_of(points.begin(), points.end(), [](const auto& p) { return p.second.again; })) return;
    std::vector<std::size_t> empty;
    std::set_difference(pointless_.begin(), pointless_.end(), at_origin_.begin(), at_origin_.end(), std::back_inserter(empty));
    pointless_ = std::move(empty);
    data_.notes.push_back(csv_.path() + ": 0, 0, 0 is read as a point that the arm touched, as every other point of the file "
                                        "is touched by several poses.");
  }

  void drop_pointless(const std::vector<bool>& is_end) {
    std::vector<std::int64_t> moved_to(data_.rows.size());
    std::size_t kept = 0;
    auto pointless = pointless_.begin();
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      const bool here = pointless != pointless_.end() && *pointless == i;
      if (here) ++pointless;
      moved_to[i] = static_cast<std::int64_t>(kept);
      if (here && !is_end[i]) {
        missing_lines_.push_back(data_.rows[i].line);
        continue;
      }
      if (here) data_.rows[i].kind = MeasurementKind::joints;
      if (kept != i) {
        data_.rows[kept] = std::move(data_.rows[i]);
        if (!commanded_.empty()) data_.commanded[kept] = data_.commanded[i];
        if (temperature_) data_.temperature[kept] = data_.temperature[i];
        if (direction_) data_.direction[kept] = std::move(data_.direction[i]);
      }
      ++kept;
    }
    data_.rows.resize(kept);
    if (!commanded_.empty()) data_.commanded.resize(kept);
    if (temperature_) data_.temperature.resize(kept);
    if (direction_) data_.direction.resize(kept);
    keep_used(data_.groups, &Measurement::group);
    keep_used(data_.targets, &Measurement::target);
    for (const Link& link : links_) {
      // Rows with a distance are never dropped, and neither are their ends.
      Measurement& row = data_.rows[static_cast<std::size_t>(moved_to[link.row])];
      row.other_row = moved_to[static_cast<std::size_t>(row.other_row)];
    }
  }

  // Drops the names that no row is left to carry.
  void keep_used(std::vector<std::string>& names, std::uint32_t Measurement::*index) {
    constexpr std::uint32_t unseen = 0xFFFFFFFFU;
    std::vector<std::uint32_t> now(names.size(), unseen);
    std::vector<std::string> used;
    for (Measurement& row : data_.rows) {
      std::uint32_t& place = now[row.*index];
      if (place == unseen) {
        place = static_cast<std::uint32_t>(used.size());
        used.push_back(std::move(names[row.*index]));
      }
      row.*index = place;
    }
    names = std::move(used);
  }

  void add_notes() {
    if (missing_lines_.empty()) return;
    std::string lines;
    for (std::size_t k = 0; k < missing_lines_.size() && k < 10; ++k) {
      lines += (k == 0 ? "" : ", ") + std::to_string(missing_lines_[k]);
    }
    if (missing_lines_.size() > 10) lines += ", ...";
    data_.notes.push_back(csv_.path() + ": " + std::to_string(missing_lines_.size()) +
                          (missing_lines_.size() == 1 ? " row" : " rows") +
                          " without a measured point (0, 0, 0 or empty) left out: line " + lines + ".");
  }

  struct Link {
    std::size_t row;
    std::string to;
    long line, column;
  };

  const std::function<void(std::size_t, std::size_t)>& progress_;
  const std::size_t kilobytes_;
  Csv csv_;
  Columns columns_;
  const Robot& robot_;
  const std::string rotation_named_;
  Dataset data_;
  std::vector<Column> q_, commanded_, position_, sigmas_;
  std::optional<RotationColumns> rotation_;
  Column distance_, to_, id_, group_, target_, sigma_, sigma_rotation_, temperature_, direction_;
  Names group_names_, target_names_;
  std::vector<Link> links_;
  std::vector<std::size_t> pointless_, at_origin_;
  std::vector<long> missing_lines_;
  std::size_t seen_ = 0;
};

}  // namespace

std::string row_name(const Dataset& data, const Measurement& row) {
  return data.targets.size() > 1 ? row.id + '/' + data.targets[row.target] : row.id;
}

std::array<double, 4> rotation_read_as(const Dataset& data, const Measurement& row, const RotationConvention& convention,
                                       double factor) {
  std::array<double, 4> numbers = row.rotation_numbers;
  if (convention.form != RotationForm::quaternion) {
    for (double& number : numbers) number *= factor;
  }
  return quaternion_from(convention, ordered(convention, data.rotation.by_axis, numbers));
}

Dataset with_rotations_read_as(Dataset data, const RotationConvention& convention, double factor) {
  for (Measurement& m : data.rows) {
    if (m.kind != MeasurementKind::pose) continue;
    m.quaternion = rotation_read_as(data, m, convention, factor);
    if (convention.form != RotationForm::quaternion) {
      for (double& number : m.rotation_numbers) number *= factor;
    }
  }
  data.rotation.convention = convention;
  return data;
}

Dataset parse_dataset(const std::string& text, const std::string& path, const Robot& robot, const std::string& rotation) {
  return Reader(text, path, robot, rotation, {}).read();
}

Dataset read_dataset(const std::string& path, const Robot& robot, const std::string& rotation,
                     const std::function<void(std::size_t, std::size_t)>& progress) {
  return Reader(read_file(path, "a measurement file"), path, robot, rotation, progress).read();
}

}  // namespace mdhcal::offline
