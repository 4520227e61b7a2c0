// SPDX-License-Identifier: MIT
#include "mdhcal/arm.hpp"

#include "arm/levers.hpp"
#include "arm/window.hpp"
#include "number/compare.hpp"
#include "number/convert.hpp"
#include "number/trigonometry.hpp"

namespace mdhcal {

void convert(double from, double& to) noexcept { to = from; }
void convert(float from, double& to) noexcept { to = static_cast<double>(from); }
void convert(double from, float& to) noexcept { to = static_cast<float>(from); }

namespace {

bool valid(const Link& link) {
  return within_bound(link.alpha_rad, max_angle_rad) && within_bound(link.a_m, max_length_m) &&
         within_bound(link.theta_rad, max_angle_rad) && within_bound(link.d_m, max_length_m) &&
         within_bound(link.beta_rad, max_angle_rad);
}

bool valid(const Joint& joint, std::int32_t own, std::int32_t count) {
  if (joint.kind != JointKind::revolute && joint.kind != JointKind::prismatic) return false;
  if (joint.sign != 1 && joint.sign != -1) return false;
  if (joint.has_min != 0 && joint.has_min != 1) return false;
  if (joint.has_max != 0 && joint.has_max != 1) return false;
  if (joint.has_min == 1 && !within_bound(joint.min, max_reading)) return false;
  if (joint.has_max == 1 && !within_bound(joint.max, max_reading)) return false;
  if (joint.has_min == 1 && joint.has_max == 1 && !(joint.min <= joint.max)) return false;
  for (std::int32_t j = 0; j < static_cast<std::int32_t>(max_joints); ++j) {
    const bool zero = within_bound(joint.coupling[j], 0.0);
    if ((j == own || j >= count) ? !zero : !within_bound(joint.coupling[j], max_coupling)) return false;
  }
  return true;
}

bool valid(const Pose<double>& pose) {
  double norm2 = 0.0;
  for (double c : pose.quaternion) {
    if (!within_bound(c, 2.0)) return false;
    norm2 += c * c;
  }
  if (!(norm2 >= 1.0 - 1e-9 && norm2 <= 1.0 + 1e-9)) return false;
  for (double p : pose.position_m) {
    if (!within_bound(p, max_length_m)) return false;
  }
  return true;
}

// Exactly: a flange that is off by a rounding is one.
bool is_identity(const Pose<double>& pose) {
  for (int k = 0; k < 3; ++k) {
    if (!within_bound(pose.position_m[k], 0.0) || !within_bound(pose.quaternion[k + 1], 0.0)) return false;
  }
  return true;
}

template <class Real>
void to_matrix(const double (&q)[4], Real (&r)[9]) {
  const double w = q[0];
  const double x = q[1];
  const double y = q[2];
  const double z = q[3];
  r[0] = static_cast<Real>(1.0 - 2.0 * (y * y + z * z));
  r[1] = static_cast<Real>(2.0 * (x * y - w * z));
  r[2] = static_cast<Real>(2.0 * (x * z + w * y));
  r[3] = static_cast<Real>(2.0 * (x * y + w * z));
  r[4] = static_cast<Real>(1.0 - 2.0 * (x * x + z * z));
  r[5] = static_cast<Real>(2.0 * (y * z - w * x));
  r[6] = static_cast<Real>(2.0 * (x * z - w * y));
  r[7] = static_cast<Real>(2.0 * (y * z + w * x));
  r[8] = static_cast<Real>(1.0 - 2.0 * (x * x + y * y));
}

template <class Real>
Status prepare(const Geometry& geometry, Arm<Real>& arm) {
  const Status status = check_geometry(geometry);
  if (status != Status::ok) return status;
  arm = Arm<Real>{};
  arm.mark = arm_mark<Real>;
  arm.joint_count = geometry.joint_count;
  double reach = 0.0;
  for (double p : geometry.last_T_flange.position_m) reach += magnitude(p);
  for (std::int32_t i = 0; i < geometry.joint_count; ++i) {
    const Link& link = geometry.link[i];
    const Joint& joint = geometry.joint[i];
    const std::uint32_t bit = 1U << static_cast<std::uint32_t>(i);
    ArmLink<Real>& out = arm.link[i];
    double sine = 0.0;
    double cosine = 1.0;
    sin_cos(link.alpha_rad, sine, cosine);
    out.sin_alpha = static_cast<Real>(sine);
    out.cos_alpha = static_cast<Real>(cosine);
    sin_cos(link.beta_rad, sine, cosine);
    out.sin_beta = static_cast<Real>(sine);
    out.cos_beta = static_cast<Real>(cosine);
    out.a_m = static_cast<Real>(link.a_m);
    out.d_m = static_cast<Real>(link.d_m);
    out.theta_rad = static_cast<Real>(link.theta_rad);
    out.sign = static_cast<Real>(joint.sign);
    if (joint.kind == JointKind::prismatic) arm.prismatic_mask |= bit;
    if (joint.has_min == 1) arm.min_mask |= bit;
    if (joint.has_max == 1) arm.max_mask |= bit;
    arm.min[i] = static_cast<Real>(joint.min);
    arm.max[i] = static_cast<Real>(joint.max);
    for (std::int32_t j = 0; j < geometry.joint_count; ++j) {
      const double ratio = i == j ? static_cast<double>(joint.sign) : joint.coupling[j];
      arm.map[i][j] = static_cast<Real>(ratio);
      if (i != j && (ratio > 0.0 || ratio < 0.0)) arm.coupled = 1;
    }
    reach += magnitude(link.a_m) + magnitude(link.d_m);
    if (joint.kind == JointKind::prismatic) {
      double travel = joint.has_min == 1 ? magnitude(joint.min) : 0.0;
      if (joint.has_max == 1 && magnitude(joint.max) > travel) travel = magnitude(joint.max);
      reach += travel;
    }
  }
  arm.has_flange = is_identity(geometry.last_T_flange) ? 0 : 1;
  to_matrix(geometry.last_T_flange.quaternion, arm.last_T_flange.rotation);
  for (int k = 0; k < 3; ++k) {
    arm.last_T_flange.position_m[k] = static_cast<Real>(geometry.last_T_flange.position_m[k]);
  }
  arm.reach_m = static_cast<Real>(reach);
  return Status::ok;
}

// Gauss and Jordan with pivots: a matrix of signs and coupling ratios. Returns false if it is singular.
template <class Real>
bool invert_map(Arm<Real>& arm) {
  const std::int32_t n = arm.joint_count;
  double left[max_joints][max_joints] = {}, right[max_joints][max_joints] = {};
  for (std::int32_t i = 0; i < n; ++i) {
    for (std::int32_t j = 0; j < n; ++j) left[i][j] = static_cast<double>(arm.map[i][j]);
    right[i][i] = 1.0;
  }
  for (std::int32_t k = 0; k < n; ++k) {
    std::int32_t pivot = k;
    for (std::int32_t i = k + 1; i < n; ++i) {
      if (magnitude(left[i][k]) > magnitude(left[pivot][k])) pivot = i;
    }
    // Ratios are within 100: a pivot below this is a rounding of zero, or makes an inverse of no use.
    const double divisor = left[pivot][k];
    if (!(magnitude(divisor) > 1e-6)) return false;  // a hundred-millionth of the largest ratio
    for (std::int32_t j = 0; j < n; ++j) {
      const double l = left[pivot][j], r = right[pivot][j];
      left[pivot][j] = left[k][j];
      right[pivot][j] = right[k][j];
      left[k][j] = l / divisor;
      right[k][j] = r / divisor;
    }
    for (std::int32_t i = 0; i < n; ++i) {
      const double factor = left[i][k];
      if (i == k) continue;
      for (std::int32_t j = 0; j < n; ++j) {
        left[i][j] -= factor * left[k][j];
        right[i][j] -= factor * right[k][j];
      }
    }
  }
  for (std::int32_t i = 0; i < n; ++i) {
    for (std::int32_t j = 0; j < n; ++j) arm.inverse_map[i][j] = static_cast<Real>(right[i][j]);
  }
  return true;
}

// Two unit vectors across gravity, and gravity: the first across the base axis that gravity is least along.
template <class Real>
void set_across(const double (&g)[3], Real (&across)[3][3]) {
  const int least = magnitude(g[0]) <= magnitude(g[1]) ? (magnitude(g[0]) <= magnitude(g[2]) ? 0 : 2)
                                                       : (magnitude(g[1]) <= magnitude(g[2]) ? 1 : 2);
  double u[3];
  for (int k = 0; k < 3; ++k) u[k] = (k == least ? 1.0 : 0.0) - g[least] * g[k];
  double size = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];  // 2/3 to 1
  double root = 1.0;
  for (int k = 0; k < 6; ++k) root = 0.5 * (root + size / root);  // Newton: no root of the processor's in a file for all
  for (double& x : u) x /= root;
  const double v[3] = {g[1] * u[2] - g[2] * u[1], g[2] * u[0] - g[0] * u[2], g[0] * u[1] - g[1] * u[0]};
  for (int k = 0; k < 3; ++k) {
    across[0][k] = static_cast<Real>(u[k]);
    across[1][k] = static_cast<Real>(v[k]);
    across[2][k] = static_cast<Real>(g[k]);
  }
}

// What of a joint's sag is left below the bound, by kilogram of payload.
double payload_range(const Geometry& geometry, const Gravity& gravity) {
  double com = 0.0;
  for (const double p : gravity.payload_com_m) com += magnitude(p);
  double range = 10000.0;
  const std::int32_t last = geometry.joint_count - 1;
  for (std::int32_t i = 0; i <= last; ++i) {
    double left = max_sag_rad();
    for (std::int32_t j = i; j <= last; ++j) left -= magnitude(gravity.compliance[i][j]) * longest_lever(geometry, i, j);
    const double by_kg = magnitude(gravity.payload_compliance[i]) * (longest_lever(geometry, i, last) + com);
    if (by_kg * range > left) range = left / by_kg;
  }
  return range;
}

template <class Real>
void add_sag(const Geometry& geometry, const Gravity& gravity, ArmTerms<Real>& terms) {
  set_across(gravity.direction, terms.across);
  double rotation[9];
  to_matrix(geometry.last_T_flange.quaternion, rotation);
  for (int k = 0; k < 3; ++k) {
    const double* r = rotation + 3 * k;
    const double* com = gravity.payload_com_m;
    const double flange = geometry.last_T_flange.position_m[k];
    terms.flange_p_m[k] = static_cast<Real>(flange);
    terms.payload_p_m[k] = static_cast<Real>(flange + (r[0] * com[0] + r[1] * com[1] + r[2] * com[2]));
  }
  for (std::int32_t i = 0; i < geometry.joint_count; ++i) {
    const std::uint32_t bit = 1U << static_cast<std::uint32_t>(i);
    for (std::int32_t j = i; j < geometry.joint_count; ++j) {
      terms.compliance[i][j] = static_cast<Real>(gravity.compliance[i][j]);
      if (magnitude(gravity.compliance[i][j]) > 0.0) terms.sag_mask |= bit;
    }
    terms.payload_compliance[i] = static_cast<Real>(gravity.payload_compliance[i]);
    if (magnitude(gravity.payload_compliance[i]) > 0.0) terms.payload_mask |= bit;
  }
  terms.sag_mask |= terms.payload_mask;
  terms.payload_range_kg = static_cast<Real>(terms.payload_mask != 0U ? payload_range(geometry, gravity) : 0.0);
}

template <class Real>
Status prepare(const Geometry& geometry, const Transmission& transmission, const JointFunctionTable& table, Arm<Real>& arm) {
  const Status status = check_transmission(geometry, transmission);
  if (status != Status::ok) return status;
  Arm<Real> made;
  if (prepare(geometry, made) != Status::ok) return Status::bad_input;
  for (std::size_t i = 0; i < static_cast<std::size_t>(geometry.joint_count); ++i) {
    const JointFunction& f = transmission.function[i];
    if (f.order_count > 0) made.terms.functions = &table;
    if (geometry.joint[i].kind == JointKind::prismatic) continue;
    const Window window = window_of(f);
    if (window.sectors < 1 || window.sectors >= turn_sectors) continue;
    made.seen_mask |= 1U << static_cast<std::uint32_t>(i);
    made.seen_first[i] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(window.first) % turn_sectors);
    made.seen_sectors[i] = static_cast<std::uint8_t>(window.sectors);
  }
  add_sag(geometry, transmission.gravity, made.terms);
  made.terms.payload_kg = static_cast<Real>(transmission.gravity.payload_kg);
  made.payload_kg = made.terms.payload_kg;
  made.has_terms = made.terms.functions != nullptr || made.terms.sag_mask != 0U ? 1 : 0;
  made.terms_share = made.has_terms != 0 ? Real{1} : Real{0};
  if (made.coupled != 0 && made.terms.functions != nullptr && !invert_map(made)) return Status::bad_input;
  arm = made;
  return Status::ok;
}

template <class Real>
Status put_payload(Arm<Real>& arm, Real payload_kg) {
  if (arm.mark != arm_mark<Real> || !within(Real{0}, payload_kg, Real{10000})) return Status::bad_input;
  if (!within_bound(payload_kg - arm.terms.payload_kg, arm.terms.payload_range_kg)) return Status::bad_input;
  arm.payload_kg = payload_kg;
  return Status::ok;
}

}  // namespace

Status check_geometry(const Geometry& geometry) noexcept {
  if (geometry.joint_count < 1 || geometry.joint_count > static_cast<std::int32_t>(max_joints)) {
    return Status::bad_input;
  }
  for (std::int32_t i = 0; i < geometry.joint_count; ++i) {
    if (!valid(geometry.link[i]) || !valid(geometry.joint[i], i, geometry.joint_count)) return Status::bad_input;
  }
  return valid(geometry.last_T_flange) ? Status::ok : Status::bad_input;
}

Status make_arm(const Geometry& geometry, Arm<double>& arm) noexcept { return prepare(geometry, arm); }
Status make_arm(const Geometry& geometry, Arm<float>& arm) noexcept { return prepare(geometry, arm); }
Status make_arm(const Geometry& geometry, const Transmission& transmission, const JointFunctionTable& table,
                Arm<double>& arm) noexcept {
  return prepare(geometry, transmission, table, arm);
}
Status make_arm(const Geometry& geometry, const Transmission& transmission, const JointFunctionTable& table,
                Arm<float>& arm) noexcept {
  return prepare(geometry, transmission, table, arm);
}
Status set_payload(Arm<double>& arm, double payload_kg) noexcept { return put_payload(arm, payload_kg); }
Status set_payload(Arm<float>& arm, float payload_kg) noexcept { return put_payload(arm, payload_kg); }

}  // namespace mdhcal
