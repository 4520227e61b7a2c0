// SPDX-License-Identifier: MIT
#include "offline/identify/mistakes.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "mdhcal/kinematics.hpp"
#include "offline/base/error.hpp"
#include "offline/base/sentences.hpp"
#include "offline/identify/registration.hpp"
#include "offline/robot/units.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {


// A few hundred rows suffice to tell a gross mistake.
std::vector<std::size_t> thinned(const std::vector<std::size_t>& rows, std::size_t most) {
  const std::size_t stride = std::max<std::size_t>(1, (rows.size() + most - 1) / most);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < rows.size(); i += stride) out.push_back(rows[i]);
  return out;
}

struct Mistake {
  std::string what;
  std::function<void(Robot&, Dataset&)> apply;
};

std::vector<Mistake> simple_mistakes(const Robot& robot) {
  std::vector<Mistake> out;
  const auto scale_joints = [](double factor) {
    return [factor](Robot& r, Dataset& d) {
      for (Measurement& m : d.rows) {
        for (std::int32_t j = 0; j < r.geometry.joint_count; ++j) {
          if (r.geometry.joint[j].kind == JointKind::revolute) m.q[static_cast<std::size_t>(j)] *= factor;
        }
      }
    };
  };
  out.push_back({"the joint angles are in radians but are read as degrees: name the columns q1_rad, q2_rad, ...",
                 scale_joints(deg_per_rad)});
  out.push_back({"the joint angles are in degrees but are read as radians: name the columns q1_deg, q2_deg, ...",
                 scale_joints(1.0 / deg_per_rad)});
  const auto scale_lengths = [](double factor) {
    return [factor](Robot&, Dataset& d) {
      for (Measurement& m : d.rows) {
        for (double& c : m.position_m) c *= factor;
        m.distance_m *= factor;
      }
    };
  };
  out.push_back({"the positions are in metres but are read as millimetres: name the columns x_m, y_m, z_m",
                 scale_lengths(1e3)});
  out.push_back({"the positions are in millimetres but are read as metres: name the columns x_mm, y_mm, z_mm",
                 scale_lengths(1e-3)});
  const std::int32_t n = robot.geometry.joint_count;
  for (std::int32_t i = 0; i < n; ++i) {
    for (std::int32_t j = i + 1; j < n; ++j) {
      out.push_back({"joints " + std::to_string(i + 1) + " and " + std::to_string(j + 1) +
                         " are swapped: check the order of the joint columns",
                     [i, j](Robot&, Dataset& d) {
                       for (Measurement& m : d.rows) {
                         std::swap(m.q[static_cast<std::size_t>(i)], m.q[static_cast<std::size_t>(j)]);
                       }
                     }});
    }
  }
  for (std::int32_t i = 0; i < n; ++i) {
    out.push_back({"joint " + std::to_string(i + 1) + " counts the other way round: set its sign in the robot file",
                   [i](Robot& r, Dataset&) { r.geometry.joint[i].sign = -r.geometry.joint[i].sign; }});
  }
  if (n >= 3 && std::fabs(robot.geometry.joint[2].coupling[1]) <= 0.0) {
    for (double ratio : {1.0, -1.0}) {
      out.push_back({"joint 3 also turns with joint 2: add [[coupling]] of = 3, by = 2, ratio = " +
                         number(ratio, 0) + " to the robot file",
                     [ratio](Robot& r, Dataset&) { r.geometry.joint[2].coupling[1] = ratio; }});
    }
  }
  return out;
}

double nominal_scale(const Robot& robot, const Dataset& data, const UnknownsOptions& options) {
  std::vector<std::size_t> rows(data.rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = i;
  const Unknowns unknowns = choose_unknowns(robot, data, rows, options);
  Selection selection;
  selection.rows = rows;
  return fit_frames(unknowns, data, selection, options.noise_mm).scale;
}

struct Split {
  std::size_t at = 0;  // index into rows
  double rms_m = HUGE_VAL;
  Frame<double> first{}, second{};
};

double squares(const std::vector<Vector3>& a, const std::vector<Vector3>& b, const Frame<double>& frame) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vector3 d = minus(transform(frame, a[i]), b[i]);
    sum += dot(d, d);
  }
  return sum;
}

// The split of the rows for which two separate registrations leave the least.
Split best_split(const Dataset& data, const std::vector<std::size_t>& rows, const Estimate& estimate) {
  const MeasurementModel model(estimate);
  std::vector<Vector3> predicted;
  std::vector<Vector3> measured;
  for (std::size_t row : rows) {
    predicted.push_back(model.target_position(data.rows[row].q.data(), data.rows[row].target));
    measured.push_back(data.rows[row].position_m);
  }
  constexpr std::size_t least = 5;
  Split best;
  const std::size_t stride = std::max<std::size_t>(1, rows.size() / 100);
  for (std::size_t at = least; at + least <= rows.size(); at += stride) {
    if (data.rows[rows[at]].group == data.rows[rows[at - 1]].group) continue;
    const auto middle = static_cast<std::ptrdiff_t>(at);
    const std::vector<Vector3> p1(predicted.begin(), predicted.begin() + middle);
    const std::vector<Vector3> m1(measured.begin(), measured.begin() + middle);
    const std::vector<Vector3> p2(predicted.begin() + middle, predicted.end());
    const std::vector<Vector3> m2(measured.begin() + middle, measured.end());
    Split split;
    split.at = at;
    split.first = rigid_fit(p1, m1, {});
    split.second = rigid_fit(p2, m2, {});
    split.rms_m = std::sqrt((squares(p1, m1, split.first) + squares(p2, m2, split.second)) /
                            static_cast<double>(rows.size()));
    if (split.rms_m < best.rms_m) best = split;
  }
  return best;
}

}  // namespace

void check_poses(const Robot& robot, const Dataset& data, const std::vector<std::size_t>& rows, const Unknowns& unknowns) {
  std::size_t scalars = 0;
  for (std::size_t row : rows) scalars += residual_count(data.rows[row].kind);
  if (rows.empty()) throw InputError(data.path, 0, 0, "There is no row to identify from.");
  const std::size_t frames = unknowns.layout.frame_columns();
  if (scalars < frames || scalars == 0) {
    throw InputError(data.path, data.rows[rows.back()].line, 0,
                     "Found " + std::to_string(scalars) + " scalar measurements in " + std::to_string(rows.size()) +
                         " rows; expected at least " + std::to_string(frames) +
                         ", the number of unknowns of the base frame and the targets.");
  }

  double widest = 0.0;
  for (std::size_t row : rows) {
    for (std::size_t j = 0; j < data.joint_count; ++j) {
      widest = std::max(widest, std::fabs(data.rows[row].q[j] - data.rows[rows.front()].q[j]));
    }
  }
  if (widest < 1e-4) {
    throw InputError(data.path, data.rows[rows.back()].line, 0,
                     "All " + std::to_string(rows.size()) +
                         " poses have the same joint readings; expected different poses. Move every joint between "
                         "the measurements, and check that the joint columns are the ones that change.");
  }
  Vector3 first = data.rows[rows.front()].position_m;
  double spread = 0.0;
  bool positions = false;
  for (std::size_t row : rows) {
    if (data.rows[row].kind == MeasurementKind::distance) continue;
    if (!positions) first = data.rows[row].position_m;
    positions = true;
    spread = std::max(spread, norm(minus(data.rows[row].position_m, first)));
  }
  if (positions && rows.size() > 2 && spread < 1e-6) {
    throw InputError(data.path, data.rows[rows.front()].line, 0,
                     "All measured positions are the same point although the joints move; expected a position a pose. "
                     "The tracker recorded nothing new.");
  }

  if (!unknowns.layout.base || !unknowns.layout.target || !positions) return;
  Arm<double> arm{};
  if (make_arm(robot.geometry, arm) != Status::ok) return;
  Pose<double> pose{};
  Frame<double> reference{};
  double turned = 0.0;
  bool seen = false;
  for (std::size_t row : rows) {
    if (forward(arm, data.rows[row].q.data(), pose) != Status::ok) continue;
    const Frame<double> frame = frame_of(pose);
    if (!seen) reference = inverted(frame);
    seen = true;
    turned = std::max(turned, norm(log_of_rotation(compose(reference, frame))));
  }
  if (turned * deg_per_rad < 0.5) {
    throw Refusal("The flange has one orientation throughout (it turns by " + number(turned * deg_per_rad, 2) +
                  " degrees at most), so the target point cannot be told from the base frame. Measure with different "
                  "orientations, or state the target in the robot file and use --tool given.");
  }
}

void check_simple_mistakes(const Robot& robot, const Dataset& data, const std::vector<std::size_t>& rows,
                           const UnknownsOptions& options, double nominal_scale_mm) {
  // A factory-new arm is off by a few millimetres; nothing below that is a gross mistake.
  if (nominal_scale_mm < 3.0) return;
  Dataset few = data;
  few.rows.clear();
  for (std::size_t row : thinned(rows, 200)) {
    if (data.rows[row].kind == MeasurementKind::distance) return;
    few.rows.push_back(data.rows[row]);
    few.rows.back().sigma_m = {};  // scales in mm are compared
  }
  const double as_it_is = nominal_scale(robot, few, options);
  double best = HUGE_VAL;
  std::string what;
  for (const Mistake& mistake : simple_mistakes(robot)) {
    Robot other = robot;
    Dataset changed = few;
    mistake.apply(other, changed);
    try {
      const double scale = nominal_scale(other, changed, options);
      // Lengths a thousandfold too small would always fit well: errors count against the measured extent.
      const double extent = changed.rows.front().position_m == few.rows.front().position_m
                                ? 1.0
                                : norm(changed.rows.front().position_m) / norm(few.rows.front().position_m);
      if (scale / std::min(1.0, extent) < best) {
        best = scale / std::min(1.0, extent);
        what = mistake.what;
      }
    } catch (const std::runtime_error&) {
      continue;  // the changed readings are out of range: not that mistake
    }
  }
  if (best < 0.2 * as_it_is) {
    throw Refusal("The nominal robot misses the measurements by " + number(as_it_is) +
                  " mm an axis (median), but only by " + number(best) + " mm if " + what + ".");
  }
}

std::optional<TrackerMove> find_tracker_move(const Dataset& data, const std::vector<std::size_t>& rows,
                                             const Unknowns& unknowns, const Fit& fit_one, double noise_mm) {
  // Residuals that the stated noise explains need no other explanation.
  if (fit_one.scale < 2.0 * (states_sigma(data) ? 1.0 : noise_mm)) return std::nullopt;
  std::vector<std::size_t> usable;
  for (std::size_t row : rows) {
    if (data.rows[row].kind != MeasurementKind::distance) usable.push_back(row);
  }
  usable = thinned(usable, 400);
  if (usable.size() < 20) return std::nullopt;

  // Two frames are fitted by turns: register the second part, move it to the first part's frame, calibrate again.
  Dataset joined = data;
  Selection selection;
  selection.rows = usable;
  FitControl control;
  control.noise_mm = noise_mm;
  control.loss = Loss::huber;
  Fit current = fit(joined, selection, unknowns.layout, fit_one.estimate, control);
  const double one_frame = current.scale;
  Frame<double> total{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  const Split split = best_split(joined, usable, current.estimate);
  if (!(split.rms_m < HUGE_VAL)) return std::nullopt;
  for (int round = 0; round < 12; ++round) {
    const MeasurementModel model(current.estimate);
    std::vector<Vector3> predicted;
    std::vector<Vector3> measured;
    for (std::size_t i = split.at; i < usable.size(); ++i) {
      const Measurement& m = joined.rows[usable[i]];
      predicted.push_back(model.target_position(m.q.data(), m.target));
      measured.push_back(m.position_m);
    }
    const Frame<double> back = rigid_fit(measured, predicted, {});
    for (std::size_t i = split.at; i < usable.size(); ++i) {
      Measurement& m = joined.rows[usable[i]];
      m.position_m = transform(back, m.position_m);
    }
    total = compose(back, total);
    current = fit(joined, selection, unknowns.layout, current.estimate, control);
    if (current.scale < one_frame / 3.0) break;
  }
  if (!(current.scale < one_frame / 3.0)) return std::nullopt;
  TrackerMove move;
  move.first_row_after = usable[split.at];
  const Vector3 place = data.rows[usable[split.at]].position_m;
  move.shift_mm = 1e3 * norm(minus(transform(total, place), place));
  move.turn_deg = deg_per_rad * norm(log_of_rotation(total));
  return move;
}

std::vector<std::string> targets_on_last_axis(const Estimate& estimate, const Dataset& data) {
  std::vector<std::string> out;
  const std::int32_t n = estimate.geometry.joint_count;
  if (estimate.geometry.joint[n - 1].kind != JointKind::revolute) return out;
  // The last axis in the flange frame: beta turns it about y, the flange transform moves it.
  const Frame<double> last_T_flange = frame_of(estimate.geometry.last_T_flange);
  const Frame<double> beta = rotation_about({0.0, estimate.geometry.link[n - 1].beta_rad, 0.0}, {0.0, 0.0, 0.0});
  for (std::size_t t = 0; t < estimate.flange_p_m.size(); ++t) {
    const Vector3 p = transform(compose(beta, last_T_flange), estimate.flange_p_m[t]);
    const double radius_mm = 1e3 * std::hypot(p[0], p[1]);
    if (radius_mm >= 1.0) continue;
    const std::string word = t < data.targets.size() && !data.targets[t].empty() ? " " + data.targets[t] : "";
    out.push_back("Target" + word + " lies " + number(radius_mm, 3) + " mm from the axis of joint " +
                  std::to_string(n) +
                  ": turning that joint hardly moves it, and theta" + std::to_string(n) + " and alpha" +
                  std::to_string(n) + " are told badly or not at all. Put the reflector off the axis.");
  }
  return out;
}

}  // namespace mdhcal::offline
