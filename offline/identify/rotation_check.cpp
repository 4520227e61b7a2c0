// SPDX-License-Identifier: MIT
#include "offline/identify/rotation_check.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mdhcal/kinematics.hpp"
#include "offline/base/error.hpp"
#include "offline/base/sentences.hpp"
#include "offline/identify/registration.hpp"
#include "offline/robot/units.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

// A ratio of misfits needs no more rows than this; a longer file is thinned evenly.
constexpr std::size_t enough_turns = 300;

// One full pose: where the flange is turned to by the positions' fit, and what the file states.
struct Turn {
  Frame<double> tracker_R_flange;
  std::size_t row;
};

std::vector<Turn> turns_of(const Dataset& data, const std::vector<std::size_t>& rows, const Estimate& fitted) {
  Arm<double> arm{};
  std::vector<Turn> out;
  if (make_arm(fitted.geometry, arm) != Status::ok) return out;
  std::vector<std::size_t> poses;
  for (const std::size_t row : rows) {
    if (data.rows[row].kind == MeasurementKind::pose) poses.push_back(row);
  }
  const std::size_t stride = std::max<std::size_t>(1, poses.size() / enough_turns);
  for (std::size_t i = 0; i < poses.size(); i += stride) {
    Pose<double> pose{};
    if (forward(arm, data.rows[poses[i]].q.data(), pose) != Status::ok) continue;
    Frame<double> turn = compose(fitted.tracker_T_base, frame_of(pose));
    for (double& p : turn.position_m) p = 0.0;
    out.push_back({turn, poses[i]});
  }
  return out;
}

// Mean angle between predicted and stated rotation, as `data` has it. `given` holds the probes' turns; where it is empty
// they are fitted. The mean, not the median: where most poses hold the flange alike, any convention fits those once the probe's
// turn is fitted, and the few that turn it are the witnesses.
double misfit(const Dataset& data, const std::vector<Turn>& turns, const std::vector<Frame<double>>& given = {}) {
  std::vector<Frame<double>> flange_R_measured;
  std::vector<std::size_t> target;
  for (const Turn& turn : turns) {
    const Measurement& m = data.rows[turn.row];
    flange_R_measured.push_back(compose(inverted(turn.tracker_R_flange), frame_of(m.quaternion, {})));
    target.push_back(m.target);
  }
  std::vector<double> angles;
  for (std::size_t t = 0; t < std::max<std::size_t>(1, data.targets.size()); ++t) {
    std::vector<Frame<double>> own;
    for (std::size_t i = 0; i < target.size(); ++i) {
      if (target[i] == t) own.push_back(flange_R_measured[i]);
    }
    if (own.empty()) continue;
    const Frame<double> probe = given.empty() ? mean_rotation(own) : given[t];
    for (const Frame<double>& each : own) angles.push_back(norm(log_of_rotation(compose(inverted(probe), each))));
  }
  return std::accumulate(angles.begin(), angles.end(), 0.0) / static_cast<double>(angles.size());
}

bool same_convention(const RotationConvention& a, const RotationConvention& b) {
  if (a.form != b.form || a.inverse != b.inverse) return false;
  if (a.form == RotationForm::quaternion) return a.scalar_last == b.scalar_last;
  if (a.form == RotationForm::vector) return true;
  return a.extrinsic == b.extrinsic && a.axis == b.axis;
}

// Root mean square distance of the measured points from their middle.
double points_spread_m(const Dataset& data, const std::vector<std::size_t>& rows) {
  Vector3 middle{};
  double count = 0.0;
  for (const std::size_t row : rows) {
    if (data.rows[row].kind != MeasurementKind::position) continue;
    middle = plus(middle, data.rows[row].position_m);
    count += 1.0;
  }
  for (double& c : middle) c /= count;
  double sum = 0.0;
  for (const std::size_t row : rows) {
    if (data.rows[row].kind != MeasurementKind::position) continue;
    const Vector3 away = minus(data.rows[row].position_m, middle);
    sum += dot(away, away);
  }
  return std::sqrt(sum / count);
}

std::string in_degrees(double angle_rad) { return number(deg_per_rad * angle_rad) + " degrees"; }

}  // namespace

std::vector<RotationFit> rotation_fits(const Dataset& data, const std::vector<std::size_t>& rows, const Estimate& fitted) {
  std::vector<RotationFit> out;
  const std::vector<Turn> turns = turns_of(data, rows, fitted);
  if (turns.empty()) return out;
  Dataset turned = data;
  const bool four = data.rotation.convention.form == RotationForm::quaternion;
  std::vector<RotationConvention> tried;
  const auto add = [&](const RotationConvention& convention) {
    if ((convention.form == RotationForm::quaternion) != four) return;
    if (std::any_of(tried.begin(), tried.end(), [&](const RotationConvention& t) { return same_convention(t, convention); })) return;
    tried.push_back(convention);
    std::vector<double> factors{1.0};
    if (!four && !data.rotation.unit_stated) factors = {1.0, deg_per_rad, rad_per_deg};
    for (const double factor : factors) {
      for (const Turn& turn : turns) {
        Measurement& m = turned.rows[turn.row];
        m.quaternion = rotation_read_as(data, data.rows[turn.row], convention, factor);
      }
      out.push_back({convention, factor, misfit(turned, turns)});
    }
  };
  add(data.rotation.convention);
  for (const char* ending : {"", "-inverse"}) {
    for (const std::string& name : rotation_names()) add(*rotation_convention(name + ending));
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const RotationFit& a, const RotationFit& b) { return a.misfit_rad < b.misfit_rad; });
  return out;
}

std::string reading_of(const RotationFit& fit) {
  if (fit.convention.form != RotationForm::quaternion && std::fabs(fit.factor - 1.0) > 0.0) {
    const char* unit = fit.factor > 1.0 ? "rad" : "deg";
    return std::string("angles in ") + (fit.factor > 1.0 ? "radians" : "degrees") + " (--rotation " + fit.convention.name +
           "), which the columns' names have to state (rx_" + unit + ", ry_" + unit + ", rz_" + unit + ")";
  }
  std::string text = fit.convention.name;
  if (fit.convention.form == RotationForm::quaternion) {
    text = fit.convention.scalar_last ? "qx, qy, qz, qw" : "qw, qx, qy, qz";
    if (fit.convention.inverse) text += " of the inverse rotation";
  }
  return text + " (--rotation " + fit.convention.name + ")";
}

void leave_out_rotations(Dataset& data) {
  for (Measurement& m : data.rows) {
    if (m.kind == MeasurementKind::pose) m.kind = MeasurementKind::position;
  }
}

namespace {

// How far rotations may lie from where positions put the flange and be sound, as read from the robot file's priors: three
// standard deviations of the twists and zeros of all joints, which positions may leave open.
double left_open_rad(const ParameterList& parameters) {
  double squares = 0.0;
  for (const Parameter& p : parameters.free) {
    if (is_angle(p.id)) squares += p.prior * p.prior;
  }
  return 3.0 * std::sqrt(squares);
}

}  // namespace

std::string why_rotations_contradict(const Robot& robot, const Dataset& data, const std::vector<std::size_t>& rows,
                                     const UnknownsOptions& options) {
  constexpr std::ptrdiff_t enough = 6;
  const auto is_pose = [&](std::size_t row) { return data.rows[row].kind == MeasurementKind::pose; };
  if (std::count_if(rows.begin(), rows.end(), is_pose) < enough) return "";
  Dataset positions = data;
  leave_out_rotations(positions);
  const Unknowns unknowns = choose_unknowns(robot, positions, rows, options);
  Selection selection;
  selection.rows = rows;
  const Fit nominal = fit_frames(unknowns, positions, selection, options.noise_mm);
  // Rotations of the calibrated arm: what its nominal geometry is wrong by is not counted against them.
  FitControl control;
  control.loss = Loss::huber;
  control.noise_mm = options.noise_mm;
  control.tolerance = 1e-2;
  const Fit fitted = fit(positions, selection, unknowns.layout, nominal.estimate, control);
  const std::vector<Turn> turns = turns_of(data, rows, fitted.estimate);
  if (turns.empty()) return "";
  const double as_read = misfit(data, turns);
  // Where the nominal geometry misses the positions widely, something else is wrong, and the rotations are no witness. What
  // it misses them by, seen from their middle, is an angle too, which the rotations have to exceed tenfold.
  const double unit_mm = states_sigma(positions) ? mean_sigma_mm(positions, rows, options.noise_mm) : 1.0;
  constexpr double tenfold = 10.0;
  const double suspicious_rad = std::max(left_open_rad(unknowns.parameters),
                                         tenfold * 1e-3 * nominal.scale * unit_mm / points_spread_m(positions, rows));
  // As for every other mistake: what is offered leaves less than a third.
  constexpr double far_better = 3.0;
  const std::string beginning = "The positions alone fit to " + number(fitted.scale * unit_mm) + " mm an axis; the rotations read as " +
                                data.rotation.convention.name + " lie " + in_degrees(as_read) + " from that in the mean. ";
  const std::string end = " The figures are of the positions alone.";
  if (as_read > suspicious_rad) {
    const RotationFit best = rotation_fits(data, rows, fitted.estimate).front();
    if (far_better * best.misfit_rad < as_read) {
      return beginning + "They fit as " + reading_of(best) + ": " + in_degrees(best.misfit_rad) + "." + end;
    }
    // A quarter of the mean angle between two random rotations (126 degrees): nothing that joint zeros explain.
    constexpr double beyond_zeros_rad = 30.0 * rad_per_deg;
    if (as_read > std::max(suspicious_rad, beyond_zeros_rad)) {
      return beginning + "They fit in no convention that is known (the best, " + best.convention.name + ", leaves " +
             in_degrees(best.misfit_rad) + "): leave them out by --rotation none, or see how the file states them." + end;
    }
  }
  if (options.fit_tool) return "";
  const double as_given = misfit(data, turns, unknowns.nominal.flange_R_probe);
  if (as_given > suspicious_rad && far_better * as_read < as_given) {
    return "The probe is turned on the flange otherwise than --tool given says: the rotations lie " + in_degrees(as_given) +
           " from it in the mean, and " + in_degrees(as_read) +
           " with its turn fitted. Use --tool fit, or state rxryrz in the robot file's [tool]." + end;
  }
  return "";
}

}  // namespace mdhcal::offline
