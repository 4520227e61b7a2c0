// SPDX-License-Identifier: MIT
#include "mdhcal/transmission.hpp"

#include "arm/levers.hpp"
#include "arm/window.hpp"
#include "mdhcal/arm.hpp"
#include "number/compare.hpp"
#include "number/square_root.hpp"
#include "number/trigonometry.hpp"

// What a joint function and the sag may come to. An integrator may compile other bounds; the proof in docs/blob.md holds up to
// a slope of 0.3 and a sag of 0.05 rad.
#ifndef MDHCAL_MAX_JOINT_FUNCTION_RAD
#define MDHCAL_MAX_JOINT_FUNCTION_RAD default_max_joint_function_rad
#endif
#ifndef MDHCAL_MAX_JOINT_FUNCTION_SLOPE
#define MDHCAL_MAX_JOINT_FUNCTION_SLOPE default_max_joint_function_slope
#endif
#ifndef MDHCAL_MAX_SAG_RAD
#define MDHCAL_MAX_SAG_RAD default_max_sag_rad
#endif

namespace mdhcal {

double max_sag_rad() noexcept { return MDHCAL_MAX_SAG_RAD; }

namespace {

constexpr auto last_order = static_cast<std::int32_t>(max_orders);
constexpr double max_payload_kg = 10000.0;

double root(double x) {
#if defined(__arm__) && (!defined(__ARM_FP) || (__ARM_FP & 8) == 0)
  return integer_square_root(x);
#else
  return __builtin_sqrt(x);
#endif
}

bool is_zero(double x) { return within_bound(x, 0.0); }

// ok, bad_input or blob_deviation.
Status judge(const JointFunction& f) {
  if (f.order_count < 0 || f.order_count > last_order || f.reserved != 0) return Status::bad_input;
  const bool stated = !is_zero(f.seen_min_rad) || !is_zero(f.seen_max_rad);
  if (!within_bound(f.seen_min_rad, max_reading) || !within_bound(f.seen_max_rad, max_reading)) return Status::bad_input;
  if (stated && !(f.seen_min_rad < f.seen_max_rad)) return Status::bad_input;
  if (f.order_count > 0 && (!stated || window_of(f).sectors < 1)) return Status::bad_input;
  double amplitudes = 0.0, slopes = 0.0;
  for (std::int32_t k = 0; k < last_order; ++k) {
    const double cosine = static_cast<double>(f.cosine_rad[k]);
    const double sine = static_cast<double>(f.sine_rad[k]);
    const double bound = k < f.order_count ? 1.0 : 0.0;
    if (!within_bound(cosine, bound) || !within_bound(sine, bound)) return Status::bad_input;
    if (k >= f.order_count) continue;
    const double amplitude = root(cosine * cosine + sine * sine);
    amplitudes += amplitude;
    slopes += static_cast<double>(k + 1) * amplitude;
  }
  const bool small = amplitudes <= MDHCAL_MAX_JOINT_FUNCTION_RAD && slopes <= MDHCAL_MAX_JOINT_FUNCTION_SLOPE;
  return small ? Status::ok : Status::blob_deviation;
}

bool has_no_function(const JointFunction& f) { return f.order_count == 0; }

Status judge(const Geometry& geometry, const Gravity& gravity) {
  const std::int32_t joints = geometry.joint_count;
  double square = 0.0;
  for (const double g : gravity.direction) {
    if (!within_bound(g, 2.0)) return Status::bad_input;
    square += g * g;
  }
  const bool directed = within_bound(square - 1.0, 1e-9);  // a unit vector written with ten digits
  if (!directed && !is_zero(square)) return Status::bad_input;
  if (!within(0.0, gravity.payload_kg, max_payload_kg)) return Status::bad_input;
  for (const double p : gravity.payload_com_m) {
    if (!within_bound(p, max_length_m)) return Status::bad_input;
  }
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(max_joints); ++i) {
    const bool turns = i < joints && geometry.joint[i].kind == JointKind::revolute;
    const double bound = turns && directed ? max_reading : 0.0;
    if (!within_bound(gravity.payload_compliance[i], bound)) return Status::bad_input;
    double sag = 0.0;
    for (std::int32_t j = 0; j < static_cast<std::int32_t>(max_joints); ++j) {
      const double compliance = gravity.compliance[i][j];
      if (!within_bound(compliance, j >= i && j < joints ? bound : 0.0)) return Status::bad_input;
      if (j >= i && j < joints) sag += magnitude(compliance) * longest_lever(geometry, i, j);
    }
    if (!(sag <= max_sag_rad())) return Status::blob_deviation;
  }
  return Status::ok;
}

}  // namespace

Status check_transmission(const Geometry& geometry, const Transmission& transmission) noexcept {
  if (check_geometry(geometry) != Status::ok) return Status::bad_input;
  Status worst = judge(geometry, transmission.gravity);
  if (worst == Status::bad_input) return worst;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(max_joints); ++i) {
    const JointFunction& f = transmission.function[i];
    const Status status = judge(f);
    if (status == Status::bad_input) return status;
    const bool turns = i < geometry.joint_count && geometry.joint[i].kind == JointKind::revolute;
    if (!turns && !has_no_function(f)) return Status::bad_input;
    if (i >= geometry.joint_count && (!is_zero(f.seen_min_rad) || !is_zero(f.seen_max_rad))) return Status::bad_input;
    if (status != Status::ok) worst = status;
  }
  return worst;
}

void evaluate_joint_function(const JointFunction& function, double reading_rad, double& value_rad, double& slope) noexcept {
  value_rad = 0.0;
  slope = 0.0;
  if (function.order_count < 1 || !within_bound(reading_rad, max_reading)) return;
  double sine = 0.0, cosine = 1.0;
  sin_cos(reading_rad, sine, cosine);
  double s = 0.0, c = 1.0;  // of k times the reading
  for (std::int32_t k = 0; k < function.order_count && k < last_order; ++k) {
    const double turned = s * cosine + c * sine;
    c = c * cosine - s * sine;
    s = turned;
    const double a = static_cast<double>(function.cosine_rad[k]);
    const double b = static_cast<double>(function.sine_rad[k]);
    value_rad += a * c + b * s;
    slope += static_cast<double>(k + 1) * (b * c - a * s);
  }
  double fall = 0.0;
  const double share = window_at(window_of(function), reading_rad, fall);
  slope = share * slope + fall * value_rad;
  value_rad *= share;
}

}  // namespace mdhcal
