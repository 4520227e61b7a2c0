// SPDX-License-Identifier: MIT
#include "offline/identify/model.hpp"

#include <cmath>

#include "mdhcal/kinematics.hpp"
#include "offline/base/error.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

// A target point at one row, in the base frame, with the frames that its derivatives are read off.
struct Reach {
  const double* q = nullptr;
  Frame<double> frames[max_joints + 2];
  Vector3 base_p_m{};
};

void frames_at(const Arm<double>& arm, const double* q, Reach& out) {
  if (link_frames(arm, q, out.frames) != Status::ok) {
    throw InputError("A joint reading is not finite or beyond what the kinematics accept.");
  }
}

Vector3 column_of(const Frame<double>& frame, int k) {
  return {frame.rotation[k], frame.rotation[3 + k], frame.rotation[6 + k]};
}

Vector3 origin_of(const Frame<double>& frame) {
  return {frame.position_m[0], frame.position_m[1], frame.position_m[2]};
}

// z_i . ((o_{j+1} - o_i) x g): what a unit mass at the end of link j does about joint i [m].
double lever_m(const Arm<double>& arm, const Frame<double>* frames, const double* g, std::int32_t i, std::int32_t j);

// A parameter moves everything beyond it along or about one line, given in the base frame.
struct Screw {
  Vector3 axis;
  Vector3 point;
  bool turns;
};

Screw screw_of(const Arm<double>& arm, const Frame<double>* frames, ParameterId id) {
  const Frame<double>& before = frames[id.link];
  const Frame<double>& after = frames[id.link + 1];
  switch (id.key) {
    case ParameterKey::alpha: return {column_of(before, 0), origin_of(before), true};
    case ParameterKey::a: return {column_of(before, 0), origin_of(before), false};
    case ParameterKey::beta: return {column_of(after, 1), origin_of(after), true};
    case ParameterKey::theta:
    case ParameterKey::d: break;
  }
  // The joint axis, before Rot_y(beta): Rot_x(alpha) z of the frame before.
  const ArmLink<double>& link = arm.link[id.link];
  const Vector3 y = column_of(before, 1);
  const Vector3 z = column_of(before, 2);
  Vector3 axis{};
  for (std::size_t k = 0; k < 3; ++k) axis[k] = link.cos_alpha * z[k] - link.sin_alpha * y[k];
  return {axis, origin_of(after), id.key == ParameterKey::theta};
}

double lever_m(const Arm<double>& arm, const Frame<double>* frames, const double* g, std::int32_t i, std::int32_t j) {
  const Screw joint = screw_of(arm, frames, {ParameterKey::theta, i});
  // Past the last link's end stands the flange.
  const Frame<double>& end = frames[j + 1 < arm.joint_count ? j + 2 : arm.joint_count + 1];
  return dot(joint.axis, cross(minus(origin_of(end), joint.point), {g[0], g[1], g[2]}));
}

// The frames of the whole map: joint functions add to the coordinates, then the sag that belongs to where they put the arm.
void reach(const Arm<double>& arm, const Estimate& estimate, bool functions, bool sag, const double* q,
           const Vector3& flange_p_m, Reach& out) {
  const Transmission& map = estimate.transmission;
  out.q = q;
  if (!functions && !sag) {
    frames_at(arm, q, out);
  } else {
    Arm<double> moved = arm;
    for (std::int32_t i = 0; functions && i < arm.joint_count; ++i) {
      if (map.function[i].order_count == 0) continue;
      double turn_rad = 0.0, slope = 0.0;
      evaluate_joint_function(map.function[i], q[i], turn_rad, slope);
      moved.link[i].theta_rad += turn_rad;
    }
    frames_at(moved, q, out);
    if (sag) {
      Arm<double> sagged = moved;
      for (std::int32_t i = 0; i < arm.joint_count; ++i) {
        for (std::int32_t j = i; j < arm.joint_count; ++j) {
          const double k = map.gravity.compliance[i][j];
          if (std::fabs(k) > 0.0) sagged.link[i].theta_rad += k * lever_m(arm, out.frames, map.gravity.direction, i, j);
        }
      }
      frames_at(sagged, q, out);
    }
  }
  out.base_p_m = transform(out.frames[arm.joint_count + 1], flange_p_m);
}

// How much each term turns its joint, per unit of its column [rad].
template <class Put>
void turns_of_terms(const Arm<double>& arm, const Estimate& estimate, const Reach& at, const Layout& layout, const Put& put) {
  double c[max_joints][max_orders + 1];
  double s[max_joints][max_orders + 1];
  bool known[max_joints] = {};
  for (const Term& term : layout.terms) {
    const auto i = static_cast<std::size_t>(term.joint);
    if (term.family == TermFamily::gravity) {
      put(term, term.prior * lever_m(arm, at.frames, estimate.transmission.gravity.direction, term.joint, term.index));
      continue;
    }
    if (!known[i]) {
      known[i] = true;
      const double r = at.q[i];
      const double cos_r = std::cos(r), sin_r = std::sin(r);
      c[i][0] = window_at(estimate.transmission.function[i], r);
      s[i][0] = 0.0;
      for (std::size_t k = 1; k <= max_orders; ++k) {
        c[i][k] = c[i][k - 1] * cos_r - s[i][k - 1] * sin_r;
        s[i][k] = s[i][k - 1] * cos_r + c[i][k - 1] * sin_r;
      }
    }
    const auto k = static_cast<std::size_t>(term.index);
    put(term, term.prior * (term.sine ? s[i][k] : c[i][k]));
  }
}

// d(target position)/d(unknowns), tracker frame [mm per unit]: three rows of `stride`, added with factor `sign`.
void add_position_jacobian(const Arm<double>& arm, const Estimate& estimate, const Reach& at, std::size_t target,
                           const Layout& layout, double sign, double* jacobian, std::size_t stride) {
  const auto put = [&](std::size_t column, const Vector3& direction) {
    for (std::size_t k = 0; k < 3; ++k) jacobian[k * stride + column] += sign * direction[k];
  };
  std::size_t column = 0;
  if (layout.base) {
    const Vector3 arm_m = minus(transform(estimate.tracker_T_base, at.base_p_m), layout.pivot_m);
    put(0, {0.0, -arm_m[2], arm_m[1]});
    put(1, {arm_m[2], 0.0, -arm_m[0]});
    put(2, {-arm_m[1], arm_m[0], 0.0});
    put(3, {1.0, 0.0, 0.0});
    put(4, {0.0, 1.0, 0.0});
    put(5, {0.0, 0.0, 1.0});
    column = 6;
  }
  if (layout.target) {
    const Frame<double>& flange = at.frames[arm.joint_count + 1];
    for (int k = 0; k < 3; ++k) {
      put(column + 3 * target + static_cast<std::size_t>(k),
          rotate(estimate.tracker_T_base, column_of(flange, k)));
    }
    column += layout.target_columns();
  }
  column += layout.probe_columns();
  for (const Parameter& parameter : layout.geometry) {
    const Screw screw = screw_of(arm, at.frames, parameter.id);
    Vector3 direction = screw.turns ? cross(screw.axis, minus(at.base_p_m, screw.point)) : screw.axis;
    for (double& component : direction) component *= 1e3 * parameter.prior;
    put(column++, rotate(estimate.tracker_T_base, direction));
  }
  if (layout.terms.empty()) return;
  Vector3 velocity[max_joints];
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    const Screw screw = screw_of(arm, at.frames, {ParameterKey::theta, i});
    velocity[i] = rotate(estimate.tracker_T_base, cross(screw.axis, minus(at.base_p_m, screw.point)));
  }
  turns_of_terms(arm, estimate, at, layout, [&](const Term& term, double turn_rad) {
    const Vector3& v = velocity[term.joint];
    put(column++, {1e3 * turn_rad * v[0], 1e3 * turn_rad * v[1], 1e3 * turn_rad * v[2]});
  });
}

// d(rotation vector residual)/d(unknowns): the angular velocity through the inverse left Jacobian at the residual.
void add_rotation_jacobian(const Arm<double>& arm, const Estimate& estimate, const Reach& at, std::size_t target,
                           const Layout& layout, double lever_mm, const Vector3& rotation_rad, double* jacobian,
                           std::size_t stride) {
  const auto put = [&](std::size_t column, const Vector3& turn_rad) {
    const Vector3 rate = inverse_left_jacobian(rotation_rad, turn_rad);
    for (std::size_t k = 0; k < 3; ++k) jacobian[k * stride + column] = lever_mm * rate[k];
  };
  if (layout.base) {
    for (std::size_t k = 0; k < 3; ++k) {
      Vector3 axis{};
      axis[k] = 1e-3;
      put(k, axis);
    }
  }
  std::size_t column = layout.base_columns() + layout.target_columns();
  for (const std::size_t probe : layout.probes) {
    for (int k = 0; k < 3 && probe == target; ++k) {
      Vector3 turn = rotate(estimate.tracker_T_base, column_of(at.frames[arm.joint_count + 1], k));
      for (double& component : turn) component *= 1e-3;
      put(column + static_cast<std::size_t>(k), turn);
    }
    column += 3;
  }
  for (const Parameter& parameter : layout.geometry) {
    const Screw screw = screw_of(arm, at.frames, parameter.id);
    if (screw.turns) {
      Vector3 turn = rotate(estimate.tracker_T_base, screw.axis);
      for (double& component : turn) component *= parameter.prior;
      put(column, turn);
    }
    ++column;
  }
  turns_of_terms(arm, estimate, at, layout, [&](const Term& term, double turn_rad) {
    Vector3 turn = rotate(estimate.tracker_T_base, screw_of(arm, at.frames, {ParameterKey::theta, term.joint}).axis);
    for (double& component : turn) component *= turn_rad;
    put(column++, turn);
  });
}

}  // namespace

Frame<double> probe_of(const Estimate& estimate, std::size_t target) {
  if (target < estimate.flange_R_probe.size()) return estimate.flange_R_probe[target];
  return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
}

std::size_t residual_count(MeasurementKind kind) {
  switch (kind) {
    case MeasurementKind::position: return 3;
    case MeasurementKind::pose: return 6;
    case MeasurementKind::joints: return 0;
    case MeasurementKind::distance: break;
  }
  return 1;
}

MeasurementModel::MeasurementModel(const Estimate& estimate) : estimate_(estimate) {
  if (make_arm(estimate.geometry, arm_) != Status::ok) {
    throw Refusal("The estimate left the valid range of a geometry: the measurements do not fit this robot.");
  }
  for (std::int32_t i = 0; i < arm_.joint_count; ++i) {
    has_functions_ = has_functions_ || estimate.transmission.function[i].order_count > 0;
    for (const double k : estimate.transmission.gravity.compliance[i]) has_sag_ = has_sag_ || std::fabs(k) > 0.0;
  }
}

Vector3 MeasurementModel::target_position(const double* q, std::size_t target) const {
  Reach at;
  reach(arm_, estimate_, has_functions_, has_sag_, q, estimate_.flange_p_m[target], at);
  return transform(estimate_.tracker_T_base, at.base_p_m);
}

std::size_t MeasurementModel::residual(const Dataset& data, std::size_t row, double* residual_mm) const {
  return residual(data, row, Layout{}, residual_mm, nullptr, 0);
}

std::size_t MeasurementModel::residual(const Dataset& data, std::size_t row, const Layout& layout, double* residual_mm,
                            double* jacobian, std::size_t stride) const {
  const Measurement& m = data.rows[row];
  const std::size_t count = residual_count(m.kind);
  if (jacobian != nullptr) {
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t c = 0; c < layout.columns(); ++c) jacobian[k * stride + c] = 0.0;
    }
  }
  if (count == 0) return 0;
  Reach at;
  reach(arm_, estimate_, has_functions_, has_sag_, m.q.data(), estimate_.flange_p_m[m.target], at);
  const Vector3 here = transform(estimate_.tracker_T_base, at.base_p_m);

  if (m.kind == MeasurementKind::distance) {
    const bool fixed_end = m.other_row < 0;
    Vector3 there = m.position_m;
    Reach other;
    std::size_t other_target = 0;
    if (!fixed_end) {
      const Measurement& end = data.rows[static_cast<std::size_t>(m.other_row)];
      other_target = end.target;
      reach(arm_, estimate_, has_functions_, has_sag_, end.q.data(), estimate_.flange_p_m[other_target], other);
      there = transform(estimate_.tracker_T_base, other.base_p_m);
    }
    const Vector3 span = minus(here, there);
    const double length = norm(span);
    residual_mm[0] = 1e3 * (length - m.distance_m);
    if (jacobian != nullptr && length > 0.0) {
      std::vector<double> ends(3 * layout.columns(), 0.0);
      add_position_jacobian(arm_, estimate_, at, m.target, layout, 1.0, ends.data(), layout.columns());
      if (!fixed_end) {
        add_position_jacobian(arm_, estimate_, other, other_target, layout, -1.0, ends.data(), layout.columns());
      }
      for (std::size_t c = 0; c < layout.columns(); ++c) {
        // Both ends move with the base: exactly no change, and not the rounding of a difference.
        if (!fixed_end && c < layout.base_columns()) continue;
        for (std::size_t k = 0; k < 3; ++k) jacobian[c] += span[k] / length * ends[k * layout.columns() + c];
      }
    }
    return count;
  }

  for (std::size_t k = 0; k < 3; ++k) residual_mm[k] = 1e3 * (here[k] - m.position_m[k]);
  if (jacobian != nullptr) {
    add_position_jacobian(arm_, estimate_, at, m.target, layout, 1.0, jacobian, stride);
  }
  if (m.kind == MeasurementKind::pose) {
    const Frame<double> predicted = compose(compose(estimate_.tracker_T_base, at.frames[arm_.joint_count + 1]),
                                            probe_of(estimate_, m.target));
    const Frame<double> measured = frame_of(m.quaternion, m.position_m);
    const Vector3 rotation_rad = log_of_rotation(compose(predicted, inverted(measured)));
    for (std::size_t k = 0; k < 3; ++k) residual_mm[3 + k] = data.rotation_lever_mm * rotation_rad[k];
    if (jacobian != nullptr) {
      add_rotation_jacobian(arm_, estimate_, at, m.target, layout, data.rotation_lever_mm, rotation_rad,
                            jacobian + 3 * stride, stride);
    }
  }
  return count;
}

Estimate moved(const Estimate& estimate, const Layout& layout, const double* step) {
  Estimate out = estimate;
  std::size_t column = 0;
  if (layout.base) {
    const Frame<double> turn = rotation_about({1e-3 * step[0], 1e-3 * step[1], 1e-3 * step[2]}, layout.pivot_m);
    out.tracker_T_base = orthonormal(compose(turn, estimate.tracker_T_base));
    for (std::size_t k = 0; k < 3; ++k) out.tracker_T_base.position_m[k] += 1e-3 * step[3 + k];
    column = 6;
  }
  if (layout.target) {
    for (std::size_t t = 0; t < layout.targets; ++t) {
      for (std::size_t k = 0; k < 3; ++k) out.flange_p_m[t][k] += 1e-3 * step[column++];
    }
  }
  for (const std::size_t probe : layout.probes) {
    const Frame<double> turn = rotation_about({1e-3 * step[column], 1e-3 * step[column + 1], 1e-3 * step[column + 2]}, {});
    out.flange_R_probe[probe] = orthonormal(compose(turn, estimate.flange_R_probe[probe]));
    column += 3;
  }
  for (const Parameter& parameter : layout.geometry) {
    set_value(out.geometry, parameter.id, value(estimate.geometry, parameter.id) + parameter.prior * step[column++]);
  }
  for (const Term& term : layout.terms) add_value(out.transmission, term, term.prior * step[column++]);
  return out;
}

std::vector<double> deviation(const Estimate& estimate, const Layout& layout) {
  std::vector<double> out;
  out.reserve(layout.geometry.size() + layout.terms.size());
  for (const Parameter& parameter : layout.geometry) {
    out.push_back((value(estimate.geometry, parameter.id) - parameter.nominal) / parameter.prior);
  }
  for (const Term& term : layout.terms) out.push_back(value(estimate.transmission, term) / term.prior);
  return out;
}

}  // namespace mdhcal::offline
