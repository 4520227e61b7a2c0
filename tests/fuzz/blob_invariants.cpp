// SPDX-License-Identifier: MIT
#include "tests/fuzz/blob_invariants.hpp"

#include <cmath>
#include <cstring>

#include "mdhcal/arm.hpp"
#include "mdhcal/crc32.hpp"
#include "mdhcal/kinematics.hpp"
#include "mdhcal/self_test.hpp"
#include "offline/output/blob_writer.hpp"

namespace mdhcal::fuzz {

namespace {

namespace at = blob_layout;

std::uint32_t number(const std::uint8_t* bytes, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t k = size; k > 0; --k) value = value << 8U | bytes[k - 1];
  return value;
}

bool inside(double value, double low, double high) { return std::isfinite(value) && value >= low && value <= high; }

bool framed(const std::uint8_t* bytes) {
  return number(bytes, 4) == 0xCCBC6BA0U && number(bytes + 4, 2) == 2 && number(bytes + 8, 4) == 8160 &&
         number(bytes + 12, 4) == at::layout_id_value && number(bytes + 8156, 4) == crc32(bytes, 8156);
}

bool counted(const BlobContent& m) {
  const auto family = static_cast<std::int32_t>(m.family);
  bool good = m.geometry.joint_count >= 1 && m.geometry.joint_count <= 8 && m.target_count >= 0 && m.target_count <= 8 &&
              family >= 0 && family <= 2 && m.double_vector_count >= 0 && m.double_vector_count <= 4 &&
              m.float_vector_count >= 0 && m.float_vector_count <= 4 && m.authentication.algorithm <= 1 &&
              (m.has_base == 0 || m.has_base == 1);
  for (std::int32_t i = 0; good && i < m.geometry.joint_count; ++i) {
    const Joint& joint = m.geometry.joint[i];
    good = (joint.kind == JointKind::revolute || joint.kind == JointKind::prismatic) &&
           (joint.sign == 1 || joint.sign == -1);
  }
  return good;
}

bool unit(const double (&q)[4]) {
  return inside(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1 - 1e-8, 1 + 1e-8) && q[0] >= 0;
}

bool ranged(const BlobContent& m) {
  Geometry nominal = m.geometry;
  std::memcpy(nominal.link, m.nominal, sizeof nominal.link);
  for (const double v : m.max_velocity) {
    if (!inside(v, 0, 1000)) return false;
  }
  bool good = check_transmission(m.geometry, m.transmission) == Status::ok && check_geometry(m.geometry) == Status::ok && check_geometry(nominal) == Status::ok && unit(m.geometry.last_T_flange.quaternion) &&
              unit(m.tracker_T_base.quaternion);
  for (const double p : m.tracker_T_base.position_m) good = good && inside(p, -1000, 1000);
  for (const Target& target : m.target) {
    for (const double p : target.flange_p_m) good = good && inside(p, -1000, 1000);
  }
  const Tolerances& t = m.tolerances;
  for (const double tolerance : {t.position_m, t.rotation_rad, static_cast<double>(t.float_position_m),
                                 static_cast<double>(t.float_rotation_rad)}) {
    good = good && tolerance > 0 && tolerance <= 1;
  }
  const BlobProvenance& p = m.provenance;
  for (const double error_m : {p.mean_before_m, p.max_before_m, p.mean_after_m, p.max_after_m}) {
    good = good && inside(error_m, 0, 1000);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    good = good && inside(p.region_min_m[k], -1000, p.region_max_m[k]) && inside(p.region_max_m[k], p.region_min_m[k], 1000);
  }
  good = good && inside(p.lean_min_m, 0, p.lean_max_m) && inside(p.lean_max_m, 0, 1000);
  return good && inside(p.lambda, 0, 1e30);
}

bool close_to_nominal(const BlobContent& m) {
  bool good = true;
  for (std::int32_t i = 0; i < m.geometry.joint_count; ++i) {
    const Link& a = m.geometry.link[i];
    const Link& b = m.nominal[i];
    good = good && std::fabs(a.a_m - b.a_m) <= 0.05 && std::fabs(a.d_m - b.d_m) <= 0.05 &&
           std::fabs(a.alpha_rad - b.alpha_rad) <= 0.05 && std::fabs(a.theta_rad - b.theta_rad) <= 0.05 &&
           std::fabs(a.beta_rad - b.beta_rad) <= 0.05;
  }
  return good;
}

template <std::size_t size>
bool terminated(const char (&text)[size]) {
  return std::memchr(text, 0, size) != nullptr;
}

bool texts_end(const BlobContent& m) {
  bool good = terminated(m.name) && terminated(m.serial) && terminated(m.provenance.tool_version) &&
              terminated(m.provenance.date) && terminated(m.provenance.method) && terminated(m.provenance.lambda_rule);
  for (const Target& target : m.target) good = good && terminated(target.name);
  return good;
}

// An arm with all that the blob says. make_arm() may refuse functions whose couplings have no inverse.
template <class Real>
bool prepared(const BlobContent& m, Arm<Real>& arm, bool& refused) {
  static JointFunctionTable table;
  const Status status = make_arm(m.geometry, m.transmission, table, arm);
  refused = status == Status::bad_input;
  if (status == Status::ok) make_table(m.transmission, table);
  return status == Status::ok || refused;
}

// Finite poses with unit rotations at zero, at the ends of the readings' range and in between.
template <class Real>
bool poses_finite(const BlobContent& m) {
  Arm<Real> arm{};
  bool refused = false;
  if (!prepared(m, arm, refused)) return false;
  if (refused) return true;
  const Real unit_tolerance = sizeof(Real) == 8 ? Real(1e-9) : Real(1e-4);
  for (const double scale : {0.0, 0.7, -1000.0, 1000.0}) {
    Real q[max_joints];
    for (std::size_t i = 0; i < max_joints; ++i) q[i] = static_cast<Real>(i % 2 == 0 ? scale : -scale / 2);
    Pose<Real> pose{};
    Jacobian<Real> jacobian{};
    if (forward(arm, q, pose, jacobian) != Status::ok) return false;
    Real norm2 = 0;
    for (const Real c : pose.quaternion) norm2 += c * c;
    if (!(std::fabs(norm2 - 1) <= unit_tolerance)) return false;
    for (const Real p : pose.position_m) {
      if (!std::isfinite(p)) return false;
    }
    for (std::int32_t j = 0; j < m.geometry.joint_count; ++j) {
      for (const Real c : jacobian.column[j]) {
        if (!std::isfinite(c)) return false;
      }
    }
  }
  return true;
}

template <class Real>
bool self_test_ends(const BlobContent& m) {
  Arm<Real> arm{};
  bool refused = false;
  if (!prepared(m, arm, refused)) return false;
  if (refused) return true;
  const Status status = self_test(m, arm);
  return status == Status::ok || status == Status::self_test_tolerance || status == Status::self_test_failed;
}

// A blob of this format version says nothing that its model does not.
bool nothing_lost(const std::uint8_t* bytes, const BlobContent& m) {
  return number(bytes + 6, 2) != 0 || std::memcmp(offline::encode(m).data(), bytes, blob_size) == 0;
}

}  // namespace

const char* broken_invariant(const std::uint8_t* bytes, const BlobContent& model, bool thorough) {
  if (!framed(bytes)) return "whole";
  if (!counted(model)) return "counted";
  if (!ranged(model)) return "ranged";
  if (!close_to_nominal(model)) return "close to nominal";
  if (!texts_end(model)) return "texts end";
  if (!poses_finite<double>(model) || !poses_finite<float>(model)) return "finite poses";
  if (thorough && (!self_test_ends<double>(model) || !self_test_ends<float>(model))) return "self-test ends";
  if (thorough && !nothing_lost(bytes, model)) return "nothing lost";
  return nullptr;
}

}  // namespace mdhcal::fuzz
