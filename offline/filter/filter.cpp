// SPDX-License-Identifier: MIT
#include "offline/filter/filter.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "mdhcal/kinematics.hpp"
#include "offline/base/error.hpp"
#include "offline/base/sentences.hpp"
#include "offline/filter/number_text.hpp"
#include "offline/import/scanner.hpp"
#include "offline/robot/arm_with_terms.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

// A target with what became of it.
struct Met {
  bool known = false;                ///< the two poses hold
  Frame<double> meant, commanded;    ///< base_T_flange: wanted, and as the nominal controller is told
  Joints q{};                        ///< the nominal joints of `meant`
};

const Frame<double>& no_turn() {
  static const Frame<double> none = frame_of(Pose<double>{{1, 0, 0, 0}, {0, 0, 0}});
  return none;
}

double distance_between(const Frame<double>& a, const Frame<double>& b) {
  return std::hypot(a.position_m[0] - b.position_m[0], a.position_m[1] - b.position_m[1], a.position_m[2] - b.position_m[2]);
}

// Half way on the straight line, the turn about one axis.
Frame<double> half_way(const Frame<double>& a, const Frame<double>& b) {
  const Pose<double> p = pose_of(a), q = pose_of(b);
  double dot = 0;
  for (int k = 0; k < 4; ++k) dot += p.quaternion[k] * q.quaternion[k];
  std::array<double, 4> middle{};
  double norm = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    middle[k] = p.quaternion[k] + (dot < 0 ? -1 : 1) * q.quaternion[k];
    norm += middle[k] * middle[k];
  }
  // Half a turn has no middle of its own: either will do.
  if (norm < 1e-12) middle = {p.quaternion[0], p.quaternion[1], p.quaternion[2], p.quaternion[3]};
  return frame_of(middle, {(a.position_m[0] + b.position_m[0]) / 2, (a.position_m[1] + b.position_m[1]) / 2, (a.position_m[2] + b.position_m[2]) / 2});
}

std::string why_not(Status status) {
  switch (status) {
    case Status::joint_limited: return "a joint limit stands in the way";
    case Status::near_singular: return "the arm is singular there";
    case Status::out_of_reach: return "it is out of reach";
    case Status::bad_input: return "its numbers are outside the library's range";
    default: return "no joints were found that meet it in its configuration";
  }
}

class Filter {
 public:
  Filter(std::string_view text, ProgramLanguage language, const std::string& path, const BlobContent& blob, const FilterOptions& options)
      : text_(text), path_(path), options_(options), program_(read_targets(text, language, path, options.frames)), nominal_(nominal_of(blob)),
        met_(program_.targets.size()) {
    if (prepare(blob.geometry, blob.transmission, prepared_) != Status::ok) {
      throw InputError(path, 0, 0, "The geometry in the blob is outside the library's valid range.");
    }
    actual_ = prepared_.arm;
    if (actual_.prismatic_mask != 0) throw InputError(path, 0, 0, "Found an arm with a joint that slides in the blob; expected turning joints, as the languages of programs have them.");
    joints_ = static_cast<std::size_t>(blob.geometry.joint_count);
  }

  FilterResult run() {
    result_.targets = program_.targets.size();
    for (const LeftOut& left : program_.left_out) note(left.at, "the target " + left.why + ": it is left as it is.");
    for (const std::size_t k : in_order()) filter(k);
    for (std::size_t k = 1; k < program_.moves.size(); ++k) judge_line(program_.moves[k - 1], program_.moves[k]);
    if (result_.stopped.empty()) result_.text = written();
    return std::move(result_);
  }

 private:
  static Geometry nominal_of(const BlobContent& blob) {
    Geometry nominal = blob.geometry;
    std::copy(std::begin(blob.nominal), std::end(blob.nominal), nominal.link);
    return nominal;
  }

  void note(std::size_t at, const std::string& text) { result_.notes.push_back({line_of_place(at), text}); }

  // line_of() counts from the text's start: for many notes the lines are looked up.
  long line_of_place(std::size_t at) {
    if (line_starts_.empty()) {
      line_starts_.push_back(0);
      for (std::size_t k = 0; k < text_.size(); ++k) {
        if (text_[k] == '\n') line_starts_.push_back(k + 1);
      }
    }
    return static_cast<long>(std::upper_bound(line_starts_.begin(), line_starts_.end(), at) - line_starts_.begin());
  }

  // As the moves come by them, for the solution nearest to the joints before; then those that no move names.
  std::vector<std::size_t> in_order() const {
    std::vector<std::size_t> order;
    std::vector<bool> taken(program_.targets.size());
    const auto take = [&](std::size_t k) {
      if (!taken[k]) order.push_back(k);
      taken[k] = true;
    };
    for (const ProgramMove& move : program_.moves) {
      for (const std::size_t k : move.targets) take(k);
    }
    for (std::size_t k = 0; k < program_.targets.size(); ++k) take(k);
    return order;
  }

  // The frame or tool of a target: by its name in the program or beside it, else as the option says.
  const Frame<double>& placed(const ProgramTarget& target, bool tool) {
    const std::map<std::string, Frame<double>>& known = tool ? program_.frames.tools : program_.frames.frames;
    std::string name = tool ? target.tool : target.frame;
    const char* what = tool ? "tool" : "frame";
    if (name.empty()) return no_turn();
    if (const auto refused = program_.frames.refused.find(name); refused != program_.frames.refused.end()) {
      fail(target, "stands in " + std::string(what) + ' ' + name + ", whose pose is not known: " + refused->second + '.');
    }
    if (const auto found = known.find(name); found != known.end()) return found->second;
    const bool zero_is_none = program_.language == ProgramLanguage::krl || program_.language == ProgramLanguage::fanuc_ls;
    if (name == "0" && zero_is_none) return no_turn();
    const std::string& option = tool ? options_.tool : options_.frame;
    if (option.empty()) {
      if (name == unknown_name && !tool && program_.language == ProgramLanguage::urscript) return no_turn();
      const std::string which = name == unknown_name ? "Found no " + std::string(what) + " for target " + target.position.name
                                                     : "Found no pose of " + std::string(what) + ' ' + name + " of target " + target.position.name;
      Scanner(text_, path_).fail_at(target.position.begin, which + "; expected it in --frames FILE, or --" + what + " with its numbers.");
    }
    std::optional<Frame<double>>& stated = tool ? stated_tool_ : stated_frame_;
    if (const auto found = known.find(option); found != known.end()) return found->second;
    if (!stated) stated = numbers_of_option(option, what);
    return *stated;
  }

  Frame<double> numbers_of_option(const std::string& option, const std::string& what) {
    const std::string where = "--" + what;
    Scanner s(option, where);
    std::vector<double> numbers;
    while (!s.done()) {
      s.skip_spaces();
      numbers.push_back(s.number().value);
      s.skip_spaces();
      if (!s.done()) s.expect(',');
    }
    const std::size_t count = 3 + rotation_of(program_.language).count();
    if (numbers.size() != count) s.fail_at(0, "Found " + std::to_string(numbers.size()) + " numbers; expected " + std::to_string(count) + ", a point and a rotation as the program's language writes them.");
    return frame_from(program_.language, numbers);
  }

  [[noreturn]] void fail(const ProgramTarget& target, const std::string& message) {
    Scanner(text_, path_).fail_at(target.position.begin, "Target " + target.position.name + ' ' + message);
  }

  // The joints of a joint target [rad].
  Joints read_joints(const ProgramTarget& target) {
    const ProgramPosition& position = target.position;
    if (position.numbers.size() < joints_) fail(target, "has " + std::to_string(position.numbers.size()) + " joints; expected " + std::to_string(joints_) + ", as the blob has.");
    Joints q{};
    for (std::size_t j = 0; j < joints_; ++j) q[j] = position.numbers[j].value * unit(position, j, target);
    return q;
  }

  double unit(const ProgramPosition& position, std::size_t j, const ProgramTarget& target) {
    if (position.kind != ProgramPositionKind::pulses) return position.radians ? 1 : one_degree_rad;
    const std::vector<double>& pulses = program_.frames.pulses_per_degree;
    if (pulses.size() < joints_) fail(target, "is in pulses; expected a line \"pulses per degree: ...\" with " + std::to_string(joints_) + " numbers in --frames FILE.");
    return one_degree_rad / pulses[j];
  }

  void stop(const ProgramTarget& target, const std::string& who, Status status) {
    result_.stopped.push_back({line_of_place(target.position.begin), "target " + target.position.name + ": " + who + ": " + why_not(status) + '.'});
  }

  void filter(std::size_t k) {
    const ProgramTarget& target = program_.targets[k];
    const bool joints = target.position.kind != ProgramPositionKind::pose;
    const bool kept = (joints && options_.keep_taught) || options_.keep.count(target.position.name) != 0;
    Met& met = met_[k];
    Solved nominal;
    Pose<double> meant{};
    if (joints) {
      nominal = {read_joints(target), Status::ok};
      nominal.status = forward(nominal_.arm(), nominal.q.data(), meant);
    } else {
      std::vector<double> numbers;
      for (const ProgramNumber& number : target.position.numbers) numbers.push_back(number.value);
      meant = pose_of(compose(compose(placed(target, false), frame_from(program_.language, numbers)), inverted(placed(target, true))));
      // The joints of the last target in the same configuration are on the branch that is meant.
      const auto [same, first] = last_.insert({flags_of(target), before_});
      const bool stated = !same->first.empty() && !first;
      nominal = nominal_.solve(meant, target.stated, target.seed ? *target.seed : stated ? same->second : before_);
      if (nominal.status == Status::ok) same->second = nominal.q;
    }
    if (nominal.status == Status::ok) before_ = nominal.q;
    if (kept) {
      note(target.position.begin, "target " + target.position.name + " stays as it was taught.");
      return;
    }
    if (nominal.status != Status::ok) return stop(target, "the nominal arm does not reach it", nominal.status);
    const Solved actual = solve_from(actual_, meant, nominal.q);
    if (actual.status != Status::ok) return stop(target, "the arm as it is does not reach it", actual.status);
    Pose<double> told{};
    const Status status = forward(nominal_.arm(), actual.q.data(), told);
    if (status != Status::ok) return stop(target, "the corrected joints", status);
    met = {true, frame_of(meant), frame_of(told), nominal.q};
    result_.most_moved_m = std::max(result_.most_moved_m, distance_between(met.meant, met.commanded));
    note_turns(target, nominal.q, actual.q);
    write(target, met, actual.q);
    ++result_.filtered;
  }

  // What is stated of the joints, for comparing.
  static std::vector<double> flags_of(const ProgramTarget& target) {
    std::vector<double> out;
    for (const FlagNumber& flag : target.flags) out.push_back(flag.number.value);
    if (!out.empty()) out.insert(out.end(), {target.stated.reading[4].least, target.stated.lower.value_or(false) ? 1.0 : 0.0, target.stated.rear.value_or(false) ? 1.0 : 0.0});
    return out;
  }

  // No parameter of an arm deviates by more than a blob may state. A joint that turns further is turned by the pose: near a
  // singularity small errors of a rotation are large turns of joints.
  void note_turns(const ProgramTarget& target, const Joints& nominal, const Joints& actual) {
    double most = 0;
    std::size_t which = 0;
    for (std::size_t j = 0; j < joints_; ++j) {
      if (((actual_.prismatic_mask >> j) & 1U) == 0U && std::abs(actual[j] - nominal[j]) > most) {
        most = std::abs(actual[j] - nominal[j]);
        which = j;
      }
    }
    if (most <= max_deviation_rad()) return;
    note(target.position.begin, "target " + target.position.name + " is near a singularity: the correction turns joint " + std::to_string(which + 1) + " by " +
                                    number(most / one_degree_rad) + " deg.");
  }

  void write(const ProgramTarget& target, const Met& met, const Joints& q) {
    std::vector<double> values;
    if (target.position.kind == ProgramPositionKind::pose) {
      const Frame<double> filtered = compose(compose(inverted(placed(target, false)), met.commanded), placed(target, true));
      values = numbers_from(program_.language, filtered);
      // Of the two quaternions of a rotation, the one on the side of that which was there.
      if (rotation_of(program_.language).form == RotationForm::quaternion) {
        double same = 0;
        for (std::size_t k = 3; k < 7; ++k) same += values[k] * target.position.numbers[k].value;
        if (same < 0) std::transform(values.begin() + 3, values.end(), values.begin() + 3, [](double v) { return -v; });
      }
      const Frame<double> read = compose(compose(placed(target, false), frame_from(program_.language, rounded(text_, program_.language, target, values))), inverted(placed(target, true)));
      result_.most_rounding_m = std::max(result_.most_rounding_m, distance_between(read, met.commanded));
    } else {
      for (std::size_t j = 0; j < joints_; ++j) values.push_back(q[j] / unit(target.position, j, target));
    }
    for (Edit& edit : number_edits(text_, program_.language, target, values)) edits_.push_back(std::move(edit));
    std::vector<Edit> flags = flag_edits(text_, program_, target, q);
    if (!flags.empty()) ++result_.flags_changed;
    for (Edit& edit : flags) edits_.push_back(std::move(edit));
  }

  // Between two filtered ends a controller goes straight, and the arm as it is does not quite: how far it is off half way, where an
  // error that grows with the square of the way is largest.
  void judge_line(const ProgramMove& from, const ProgramMove& to) {
    if (to.kind != MoveKind::line || to.targets.empty() || from.targets.empty()) return;
    const Met& a = met_[from.targets.back()];
    const Met& b = met_[to.targets.back()];
    const ProgramTarget& end = program_.targets[to.targets.back()];
    if (!a.known || !b.known || end.position.kind != ProgramPositionKind::pose) return;
    const Frame<double>& tool = placed(end, true);
    const Frame<double> meant = half_way(compose(a.meant, tool), compose(b.meant, tool));
    const Frame<double> told = half_way(compose(a.commanded, tool), compose(b.commanded, tool));
    const Pose<double> flange = pose_of(compose(meant, inverted(tool)));
    const Solved nominal = solve_from(nominal_.arm(), flange, b.q);
    const Solved actual = nominal.status == Status::ok ? solve_from(actual_, flange, nominal.q) : nominal;
    Pose<double> needed{};
    if (actual.status != Status::ok || forward(nominal_.arm(), actual.q.data(), needed) != Status::ok) {
      note(to.at, "the line to target " + end.position.name + " could not be judged half way: " + why_not(actual.status) + '.');
      return;
    }
    const double sag = distance_between(compose(frame_of(needed), tool), told);
    if (!(sag > options_.least_sag_m)) return;
    note(to.at, "the line to target " + end.position.name + ", " + number(1e3 * distance_between(compose(a.meant, tool), compose(b.meant, tool)), 0) +
                    " mm long, is off its straight by " + number(1e3 * sag) + " mm half way; a target there would make it a quarter of that.");
  }

  std::string written() {
    std::stable_sort(edits_.begin(), edits_.end(), [](const Edit& a, const Edit& b) { return std::pair(a.begin, a.order) < std::pair(b.begin, b.order); });
    std::string out;
    std::size_t at = 0;
    for (const Edit& edit : edits_) {
      out += text_.substr(at, edit.begin - at);
      out += edit.text;
      at = edit.end;
    }
    out += text_.substr(at);
    return out;
  }

  std::string_view text_;
  const std::string& path_;
  const FilterOptions& options_;
  TargetText program_;
  Postures nominal_;
  ArmWithTerms<double> prepared_;
  Arm<double> actual_{};
  std::size_t joints_ = 0;
  Joints before_{};
  std::map<std::vector<double>, Joints> last_;
  std::vector<Met> met_;
  std::optional<Frame<double>> stated_tool_, stated_frame_;
  std::vector<Edit> edits_;
  std::vector<std::size_t> line_starts_;
  FilterResult result_;
};

}  // namespace

FilterResult filter_program(std::string_view text, ProgramLanguage language, const std::string& path, const BlobContent& blob, const FilterOptions& options) {
  return Filter(text, language, path, blob, options).run();
}

}  // namespace mdhcal::offline
