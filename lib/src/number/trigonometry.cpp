// SPDX-License-Identifier: MIT
#include "number/trigonometry.hpp"

#include "number/compare.hpp"
#include "number/real.hpp"
#include "number/sin_cos.hpp"

namespace mdhcal {

void sin_cos(Real angle_rad, Real& sine, Real& cosine) noexcept { sin_cos_inline(angle_rad, sine, cosine); }

Real arc_tangent(Real y, Real x) noexcept {
  const Real ay = magnitude(y);
  const Real ax = magnitude(x);
  const bool steep = ay > ax;
  const Real small = steep ? ax : ay;
  const Real large = steep ? ay : ax;
  if (!(large > Real{0})) return x + y;
  // small / large = tan(theta): theta = base + atan(u) with u = above / below small.
  Real above = small;
  Real below = large;
  Real base = 0;
  Real base_low = 0;
  if (small > Real(0.6875) * large) {
    above = small - large;
    below = small + large;
    base = Real(0.5) * Trig::right_high;
    base_low = Real(0.5) * Trig::right_low;
  } else if (small > Real(0.4375) * large) {
    above = (small + small) - large;
    below = (large + large) + small;
    base = Trig::half_high;
    base_low = Trig::half_low;
  }
  const Real u = above / below;
  const Pair product = exact_product(u, below);
  const Real u_low = ((above - product.high) - product.low) / below;
  const Real z = u * u;
  base_low += u_low + u * z * polynomial(Trig::tangent, z);
  Pair theta = exact_sum(base, u);
  theta.low += base_low;
  if (steep) {
    const Pair turned = exact_sum(Trig::right_high, -theta.high);
    theta = {turned.high, turned.low + (Trig::right_low - theta.low)};
  }
  if (x < Real{0}) {
    const Pair turned = exact_sum(Trig::right_high + Trig::right_high, -theta.high);
    theta = {turned.high, turned.low + ((Trig::right_low + Trig::right_low) - theta.low)};
  }
  const Real angle = theta.high + theta.low;
  return y < Real{0} ? -angle : angle;
}

Real arc_cosine(Real cosine) noexcept {
  if (cosine > Real{1}) return 0;
  if (cosine < Real{-1}) return Trig::right_high + Trig::right_high;
  return arc_tangent(square_root((Real{1} - cosine) * (Real{1} + cosine)), cosine);
}

}  // namespace mdhcal
