// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. What the transmission adds to signs and couplings, at given readings. Written out
// where GCC at -O2 would leave loops of two or three, which cost as much as the arithmetic.
#pragma once

#include "mdhcal/arm.hpp"
#include "number/compare.hpp"
#include "number/real.hpp"

namespace mdhcal {
namespace {

/// Value, slope and curvature of a joint function.
struct FunctionValue {
  Real value, slope, curvature;
};

/// The sector of a turn that a reading is in, and `u` in it, -1 at its beginning, 1 at its end.
[[gnu::always_inline]] inline std::int32_t sector_of(Real reading_rad, Real& u) {
  const Real x = reading_rad * Real(10.185916357881302);  // 64 / (2 pi)
  auto whole = static_cast<std::int32_t>(x);
  if (static_cast<Real>(whole) > x) --whole;
  u = Real{2} * (x - static_cast<Real>(whole)) - Real{1};
  return whole & (turn_sectors - 1);
}

/// Horner's scheme from coefficient k down.
template <int k>
[[gnu::always_inline]] inline Real horner(const float* c, Real u, Real sum) {
  sum = sum * u + static_cast<Real>(c[k]);
  if constexpr (k == 0) {
    return sum;
  } else {
    return horner<k - 1>(c, u, sum);
  }
}

template <int k>
[[gnu::always_inline]] inline void horner(const float* c, Real u, FunctionValue& f) {
  f.curvature = f.curvature * u + f.slope;
  f.slope = f.slope * u + f.value;
  f.value = f.value * u + static_cast<Real>(c[k]);
  if constexpr (k > 0) horner<k - 1>(c, u, f);
}

constexpr int highest = static_cast<int>(sector_terms) - 1;

/// The value alone; its bits are those of function_value().
[[gnu::always_inline]] inline Real function_at(const float (&table)[turn_sectors][sector_terms], Real reading_rad) {
  Real u;
  const float* c = table[sector_of(reading_rad, u)];
  return horner<highest - 1>(c, u, static_cast<Real>(c[highest]));
}

/// The value and its first two derivatives by the reading.
[[gnu::always_inline]] inline FunctionValue function_value(const float (&table)[turn_sectors][sector_terms], Real reading_rad) {
  constexpr Real by_reading = Real(20.371832715762604);  // du / dr
  Real u;
  const float* c = table[sector_of(reading_rad, u)];
  FunctionValue f{static_cast<Real>(c[highest]), 0, 0};
  horner<highest - 1>(c, u, f);
  return {f.value, by_reading * f.slope, by_reading * by_reading * Real{2} * f.curvature};
}

/// A vector across gravity, and with `along` what of it is along gravity.
template <bool along>
struct Seen {
  Real u, v;
};
template <>
struct Seen<true> {
  Real u, v, w;
};

/// a + k b.
template <bool along>
[[gnu::always_inline]] inline Seen<along> add(const Seen<along>& a, Real k, const Seen<along>& b) {
  if constexpr (along) {
    return {a.u + k * b.u, a.v + k * b.v, a.w + k * b.w};
  } else {
    return {a.u + k * b.u, a.v + k * b.v};
  }
}

/// a x b: across gravity, along it.
inline Real cross_u(const Seen<true>& a, const Seen<true>& b) { return a.v * b.w - a.w * b.v; }
inline Real cross_v(const Seen<true>& a, const Seen<true>& b) { return a.w * b.u - a.u * b.w; }
template <bool along>
[[gnu::always_inline]] inline Real cross_along(const Seen<along>& a, const Seen<along>& b) {
  return a.u * b.v - a.v * b.u;
}

/// The joints' axes and the weights' points.
template <bool along>
struct Levers {
  Seen<along> axis[max_joints];
  Seen<along> point[max_joints + 1];  ///< [i]: on axis i; [joint_count]: the flange's origin
  Seen<along> payload;
};

/// The sag of each joint [rad] and, seeing along gravity too, its derivative by each joint's coordinate before sag:
/// sag_i = g . (z_i x V_i), V_i = sum over j >= i of k_ij (point_{j+1} - point_i). A turn about an axis l <= i turns z_i and V_i
/// as a whole; one about l > i turns the weights beyond it about point_l.
template <bool along>
inline void sag_of(const Arm<Real>& arm, const Levers<along>& levers, Real* sag, Real (*slope)[max_joints]) {
  const ArmTerms<Real>& terms = arm.terms;
  const Real extra = arm.payload_kg - terms.payload_kg;
  const std::int32_t joints = arm.joint_count;
  for (std::int32_t i = 0; i < joints; ++i) {
    sag[i] = 0;
    if (((terms.sag_mask >> static_cast<std::uint32_t>(i)) & 1U) == 0U) {
      if constexpr (along) {
        for (std::int32_t j = 0; j < joints; ++j) slope[i][j] = 0;
      }
      continue;
    }
    Seen<along> axis = levers.axis[i];
    axis.u *= arm.terms_share;
    axis.v *= arm.terms_share;
    if constexpr (along) axis.w *= arm.terms_share;
    Real weight = extra * terms.payload_compliance[i];
    Seen<along> moment = add(Seen<along>{}, weight, levers.payload);
    const Real* compliance = terms.compliance[i];
    for (std::int32_t j = joints - 1; j > i; --j) {
      weight += compliance[j];
      moment = add(moment, compliance[j], levers.point[j + 1]);
      if constexpr (along) {
        const Seen<along>& other = levers.axis[j];
        if (((arm.prismatic_mask >> static_cast<std::uint32_t>(j)) & 1U) != 0U) {
          slope[i][j] = weight * cross_along(axis, other);
          continue;
        }
        const Seen<along> lever = add(moment, -weight, levers.point[j]);
        slope[i][j] = axis.u * cross_v(other, lever) - axis.v * cross_u(other, lever);
      }
    }
    weight += compliance[i];
    moment = add(moment, compliance[i], levers.point[i + 1]);
    const Seen<along> lever = add(moment, -weight, levers.point[i]);
    sag[i] = cross_along(axis, lever);
    if constexpr (along) {
      const Seen<along> turned{cross_u(axis, lever), cross_v(axis, lever), 0};
      for (std::int32_t l = 0; l <= i; ++l) {
        const bool slides = ((arm.prismatic_mask >> static_cast<std::uint32_t>(l)) & 1U) != 0U;
        slope[i][l] = slides ? Real{0} : cross_along(levers.axis[l], turned);
      }
    }
  }
}

/// Turns sine and cosine by a sag: its own to the eighth order, which for 0.05 rad is below the rounding.
[[gnu::always_inline]] inline void turn_by_sag(Real sag, Real& sine, Real& cosine) {
  const Real square = sag * sag;
  const Real s = sag + sag * square * (Real(-1.0 / 6) + square * (Real(1.0 / 120) - square * Real(1.0 / 5040)));
  const Real c = square * (Real(-0.5) + square * (Real(1.0 / 24) - square * Real(1.0 / 720)));  // cos - 1 to sag^6
  const Real turned = sine + (sine * c + cosine * s);
  cosine = cosine + (cosine * c - sine * s);
  sine = turned;
}

}  // namespace
}  // namespace mdhcal
