// SPDX-License-Identifier: MIT
#include "offline/import/join.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <set>

#include "offline/base/error.hpp"

namespace mdhcal::offline {

namespace {

constexpr const char* name_parts[] = {"id", "group", "target", "collection"};

std::string part_of(const SourceRow& row, const std::string& part) {
  const auto found = row.parts.find(part);
  return found == row.parts.end() ? std::string() : found->second;
}

std::string small_name(const std::string& name) {
  std::string out;
  for (const char c : name) out += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

std::string first_names(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t k = 0; k < names.size() && k < 8; ++k) text += (k == 0 ? "" : ", ") + names[k];
  return names.size() > 8 ? text + ", ..." : text;
}

std::string seconds_text(double seconds) {
  char text[40];
  (void)std::snprintf(text, sizeof text, "%.3f s", seconds);
  return text;
}

// The joints of a log by the names of its rows.
std::map<std::string, const SourceRow*> by_name(const SourceTable& log) {
  std::map<std::string, const SourceRow*> rows;
  for (const SourceRow& row : log.rows) {
    const std::string name = small_name(part_of(row, "id"));
    if (name.empty()) continue;
    const auto [entry, added] = rows.emplace(name, &row);
    if (!added && entry->second->joints != row.joints) {
      throw InputError(log.path, row.line, 1, "Found the name \"" + part_of(row, "id") + "\" a second time with other joints (first in line " +
                                                  std::to_string(entry->second->line) + "); expected each name once, or --join order.");
    }
  }
  return rows;
}

// How many rows of an export have the name of a row of the log in this part of their names.
std::size_t agreeing(const SourceTable& table, const std::map<std::string, const SourceRow*>& log, const std::string& part) {
  return static_cast<std::size_t>(std::count_if(table.rows.begin(), table.rows.end(),
                                                [&](const SourceRow& row) { return log.count(small_name(part_of(row, part))) != 0; }));
}

class Joiner {
 public:
  Joiner(const std::vector<SourceTable>& exports, const SourceTable* log, const Robot& robot, const JoinOptions& options,
         const std::vector<std::string>& target_names)
      : exports_(exports), log_(log), robot_(robot), options_(options), target_names_(target_names) {}

  Joined run() {
    for (const SourceTable& table : exports_) {
      if (!table.measures) throw InputError(table.path, 1, 1, "Found joints and no measured point; expected x, y, z there, or this file as --robot-log.");
      if (table.has_joints && log_ != nullptr) {
        throw InputError(table.path, 1, 1, "Found joints beside the points, and --robot-log " + log_->path + " as well; expected the joints in one of them.");
      }
      if (!table.has_joints && log_ == nullptr) {
        throw InputError(table.path, 1, 1, "Found points without joints; expected --robot-log with the controller's log or program, or columns q1, q2, ... beside the points.");
      }
    }
    if (log_ == nullptr) {
      own_joints();
    } else if (!log_->has_joints) {
      throw InputError(log_->path, 1, 1, "Found no joints; expected the robot's " + std::to_string(robot_.geometry.joint_count) + " joints in columns q1, q2, ... .");
    } else {
      with_log();
    }
    if (out_.rows.empty()) throw InputError(exports_.front().path, 1, 1, "Found no measured point with joints; expected at least one.");
    return std::move(out_);
  }

 private:
  void with_log() {
    JoinBy by = options_.by;
    const auto named = by == JoinBy::told || by == JoinBy::id ? by_name_or_empty() : std::map<std::string, const SourceRow*>{};
    if (by == JoinBy::told) by = told(named);
    switch (by) {
      case JoinBy::id: by_id(named); break;
      case JoinBy::order: by_order(); break;
      default: by_time(); break;
    }
  }

  std::map<std::string, const SourceRow*> by_name_or_empty() const {
    if (options_.by == JoinBy::id) return by_name(*log_);
    // A log in which names repeat is not joined by them unless that is asked for.
    try {
      return by_name(*log_);
    } catch (const InputError&) {
      return {};
    }
  }

  JoinBy told(const std::map<std::string, const SourceRow*>& named) {
    std::size_t best = 0, rows = 0;
    for (const SourceTable& table : exports_) {
      std::size_t most = 0;
      for (const char* part : name_parts) most = std::max(most, agreeing(table, named, part));
      best += most;
      rows += table.rows.size();
    }
    // Half of the names in common are no accident.
    if (best > 0 && 2 * best >= std::min(rows, named.size())) return JoinBy::id;
    const bool as_many = std::all_of(exports_.begin(), exports_.end(), [&](const SourceTable& t) { return t.row_count == log_->row_count; });
    if (as_many) {
      out_.notes.push_back("Joined by order: " + exports_.front().path + " and " + log_->path + " have " + std::to_string(log_->row_count) +
                           " rows each and no names in common (--join says otherwise).");
      return JoinBy::order;
    }
    const bool timed = log_->rows.front().time_s.has_value() && exports_.front().rows.front().time_s.has_value();
    throw InputError(exports_.front().path, 1, 1,
                     "Found " + std::to_string(exports_.front().row_count) + " rows here and " + std::to_string(log_->row_count) + " in " + log_->path +
                         ", and " + (named.empty() ? "no names in the latter" : "no names in common") + "; expected --join id (with names that agree), order (with as many rows)" +
                         (timed ? " or time (both have times; --clock-offset is what the tracker's clock is ahead)." : "."));
  }

  // Whether the files are a target each.
  bool files_are_targets(const std::string& part, bool by_order) const {
    if (exports_.size() < 2) return false;
    for (const SourceTable& table : exports_) {
      if (!table.points.empty()) return false;
      if (by_order && table.row_count != log_->row_count) return false;
    }
    if (by_order) return true;
    std::set<std::string> names;
    for (const SourceTable& table : exports_) {
      std::set<std::string> own;
      for (const SourceRow& row : table.rows) own.insert(small_name(part_of(row, part)));
      for (const std::string& name : own) {
        if (!names.insert(name).second) return true;
      }
    }
    return false;
  }

  std::vector<std::string> names_of_files() {
    std::vector<std::string> names = target_names_;
    if (names.empty() && robot_.targets.size() == exports_.size()) {
      for (const TargetPoint& target : robot_.targets) names.push_back(target.name);
    }
    if (names.empty()) {
      for (const SourceTable& table : exports_) names.push_back(std::filesystem::path(table.path).stem().string());
    }
    if (names.size() != exports_.size()) {
      throw InputError("Found " + std::to_string(names.size()) + " names for " + std::to_string(exports_.size()) + " files; expected --targets with a name for each.");
    }
    std::string said;
    for (std::size_t k = 0; k < names.size(); ++k) said += (k == 0 ? "" : ", ") + exports_[k].path + " is " + names[k];
    out_.notes.push_back("A target a file: " + said + '.');
    return names;
  }

  void own_joints() {
    const bool targets = files_are_targets("id", false);
    const std::vector<std::string> names = targets ? names_of_files() : std::vector<std::string>(exports_.size());
    std::size_t before = 0;
    for (std::size_t f = 0; f < exports_.size(); ++f) {
      const std::string part = varying_target(exports_[f], "id");
      for (const SourceRow& row : exports_[f].rows) {
        if (!row.position_m) continue;
        const std::string id = part_of(row, "id");
        out_.rows.push_back({id.empty() ? std::to_string(row.index + 1 + (targets ? 0 : before)) : id,
                             !row.point.empty() ? row.point : targets ? names[f] : part_of(row, part), &row, *row.joints});
      }
      before += exports_[f].row_count;
    }
  }

  // The part of the names that tells targets apart: "target" if it takes several values or one of the robot's; where the rows
  // repeat the pose's name, the part that makes them differ. Empty if there is none.
  std::string varying_target(const SourceTable& table, const std::string& key) const {
    const auto values = [&](const std::string& part) {
      std::set<std::string> all;
      for (const SourceRow& row : table.rows) all.insert(part_of(row, part));
      return all;
    };
    if (key != "target") {
      const auto stated = values("target");
      const bool known = std::any_of(robot_.targets.begin(), robot_.targets.end(), [&](const TargetPoint& t) { return stated.count(t.name) != 0; });
      if (stated.size() > 1 || known) return "target";
    }
    std::set<std::pair<std::string, std::string>> seen;
    const auto repeats = [&](const std::string& part) {
      seen.clear();
      return std::any_of(table.rows.begin(), table.rows.end(), [&](const SourceRow& row) {
        return !seen.emplace(part_of(row, key) + '\n' + part_of(row, part), row.point).second;
      });
    };
    if (!repeats(key)) return "";
    for (const char* part : name_parts) {
      const std::size_t count = values(part).size();
      if (part != key && count > 1 && count <= 8 && !repeats(part)) return part;
    }
    return "";
  }

  void by_id(const std::map<std::string, const SourceRow*>& log) {
    std::set<const SourceRow*> used;
    std::vector<std::string> without_joints;
    std::string key = "id";
    std::size_t most = 0;
    for (const char* part : name_parts) {
      std::size_t count = 0;
      for (const SourceTable& table : exports_) count += agreeing(table, log, part);
      if (count > most) {
        most = count;
        key = part;
      }
    }
    if (most == 0) {
      std::vector<std::string> here, there;
      for (const SourceRow& row : exports_.front().rows) here.push_back('"' + part_of(row, "id") + '"');
      for (const auto& [name, row] : log) there.push_back('"' + part_of(*row, "id") + '"');
      throw InputError(exports_.front().path, 1, 1, "Found no name that is also in " + log_->path + "; expected names in common: here " + first_names(here) +
                                                        "; there " + (there.empty() ? "none" : first_names(there)) + " (--join order, or \"names\" in a profile).");
    }
    const bool targets = files_are_targets(key, false);
    const std::vector<std::string> names = targets ? names_of_files() : std::vector<std::string>(exports_.size());
    for (std::size_t f = 0; f < exports_.size(); ++f) {
      const std::string part = varying_target(exports_[f], key);
      for (const SourceRow& row : exports_[f].rows) {
        const std::string name = part_of(row, key);
        const auto found = log.find(small_name(name));
        if (found == log.end()) {
          without_joints.push_back(name.empty() ? "line " + std::to_string(row.line) : name);
          continue;
        }
        used.insert(found->second);
        if (!row.position_m) continue;
        out_.rows.push_back({part_of(*found->second, "id"), !row.point.empty() ? row.point : targets ? names[f] : part_of(row, part), &row, *found->second->joints});
      }
    }
    sort_by_pose();
    std::vector<std::string> without_point;
    for (const auto& [name, row] : log) {
      if (used.count(row) == 0) without_point.push_back(part_of(*row, "id"));
    }
    out_.notes.push_back("Joined by name" + (key == "id" ? std::string() : " (the " + key + " of the point)") + ": " + std::to_string(out_.rows.size()) + " points.");
    if (!without_joints.empty()) out_.notes.push_back(std::to_string(without_joints.size()) + " points without joints are left out: " + first_names(without_joints) + '.');
    if (!without_point.empty()) out_.notes.push_back(std::to_string(without_point.size()) + " rows of joints without a point are left out: " + first_names(without_point) + '.');
  }

  // The targets of one pose follow each other.
  void sort_by_pose() {
    std::map<std::string, std::size_t> order;
    bool several = false;
    for (const JoinedRow& row : out_.rows) {
      order.emplace(row.id, order.size());
      several = several || row.target != out_.rows.front().target;
    }
    if (several) {
      std::stable_sort(out_.rows.begin(), out_.rows.end(), [&](const JoinedRow& a, const JoinedRow& b) { return order[a.id] < order[b.id]; });
    }
  }

  void by_order() {
    const bool targets = files_are_targets("", true);
    const std::vector<std::string> names = targets ? names_of_files() : std::vector<std::string>(exports_.size());
    std::size_t total = 0;
    for (const SourceTable& table : exports_) total += table.row_count;
    if (!targets && total != log_->row_count) {
      throw InputError(exports_.front().path, 1, 1, "Found " + std::to_string(total) + " rows of points and " + std::to_string(log_->row_count) + " of joints in " + log_->path +
                                                        "; expected as many, or --join id or time.");
    }
    std::size_t before = 0;
    for (std::size_t f = 0; f < exports_.size(); ++f) {
      for (const SourceRow& row : exports_[f].rows) {
        if (!row.position_m) continue;
        const std::size_t index = row.index + (targets ? 0 : before);
        const SourceRow& joints = log_->rows[index];
        std::string id = part_of(joints, "id");
        if (id.empty()) id = part_of(row, "id");
        if (id.empty()) id = std::to_string(index + 1);
        out_.rows.push_back({id, !row.point.empty() ? row.point : names[f], &row, *joints.joints});
      }
      before += exports_[f].row_count;
    }
    sort_by_pose();
  }

  bool moves(std::size_t index) const {
    for (const std::size_t other : {index == 0 ? index : index - 1, index + 1 == log_->rows.size() ? index : index + 1}) {
      for (std::size_t j = 0; j < static_cast<std::size_t>(robot_.geometry.joint_count); ++j) {
        const double limit = robot_.geometry.joint[j].kind == JointKind::prismatic ? options_.still_m : options_.still_rad;
        if (std::abs((*log_->rows[index].joints)[j] - (*log_->rows[other].joints)[j]) > limit) return true;
      }
    }
    return false;
  }

  void by_time() {
    const auto timed = [](const SourceTable& table) {
      for (const SourceRow& row : table.rows) {
        if (!row.time_s) throw InputError(table.path, row.line, 1, "Found a row without a time; expected a column of times (t) for --join time.");
      }
    };
    timed(*log_);
    for (std::size_t k = 1; k < log_->rows.size(); ++k) {
      if (*log_->rows[k].time_s < *log_->rows[k - 1].time_s) {
        throw InputError(log_->path, log_->rows[k].line, 1, "Found a time before that of the row above; expected a log in the order of time.");
      }
    }
    std::vector<std::string> far, moving;
    double largest = 0;
    std::size_t before = 0;
    for (const SourceTable& table : exports_) {
      timed(table);
      for (const SourceRow& row : table.rows) {
        if (!row.position_m) continue;
        std::string id = part_of(row, "id");
        if (id.empty()) id = std::to_string(before + row.index + 1);
        const double t = *row.time_s - options_.clock_offset_s;
        const auto later = std::lower_bound(log_->rows.begin(), log_->rows.end(), t, [](const SourceRow& r, double time) { return *r.time_s < time; });
        auto index = static_cast<std::size_t>(later - log_->rows.begin());
        if (index == log_->rows.size() || (index > 0 && t - *log_->rows[index - 1].time_s <= *log_->rows[index].time_s - t)) --index;
        const double gap = std::abs(t - *log_->rows[index].time_s);
        if (gap > options_.max_gap_s) {
          far.push_back(id);
        } else if (moves(index)) {
          moving.push_back(id);
        } else {
          largest = std::max(largest, gap);
          out_.rows.push_back({id, row.point, &row, *log_->rows[index].joints});
        }
      }
      before += table.row_count;
    }
    if (out_.rows.empty()) {
      throw InputError(exports_.front().path, 1, 1, "Found no point with a row of joints at rest within " + seconds_text(options_.max_gap_s) + " (" + std::to_string(far.size()) + " too far in time, " +
                                                        std::to_string(moving.size()) + " while the robot moved); expected --clock-offset, --max-gap or another log.");
    }
    out_.notes.push_back("Joined by time: " + std::to_string(out_.rows.size()) + " points, " + seconds_text(largest) + " from their joints at most.");
    if (!far.empty()) out_.notes.push_back(std::to_string(far.size()) + " points with no row of joints within " + seconds_text(options_.max_gap_s) + " are left out: " + first_names(far) + '.');
    if (!moving.empty()) out_.notes.push_back(std::to_string(moving.size()) + " points at which the robot moved are left out: " + first_names(moving) + '.');
  }

  const std::vector<SourceTable>& exports_;
  const SourceTable* log_;
  const Robot& robot_;
  const JoinOptions& options_;
  const std::vector<std::string>& target_names_;
  Joined out_;
};

}  // namespace

Joined join(const std::vector<SourceTable>& exports, const SourceTable* log, const Robot& robot, const JoinOptions& options,
            const std::vector<std::string>& target_names) {
  return Joiner(exports, log, robot, options, target_names).run();
}

}  // namespace mdhcal::offline
