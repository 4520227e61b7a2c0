// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. Closed-form inverse kinematics of the nominal families, as starting values.
#pragma once

#include "arm/chain.hpp"
#include "mdhcal/solutions.hpp"
#include "number/real.hpp"
#include "arm/rotation.hpp"
#include "arm/vector.hpp"
#include "number/trigonometry.hpp"

namespace mdhcal {
namespace {

/// The arm as screws: base_T_flange(c) = turn(axis 1, c_1) ... turn(axis 6, c_6) zero_T_flange, c the joint coordinates.
struct Screws {
  Vector axis[6];
  Vector point[6];
  Vector meet;     ///< where the last two or three axes meet, nearly
  Frame<Real> zero;
  ArmFamily family;
};

inline Vector turned(const Vector& axis, Real angle, const Vector& p) {
  Real sine = 0;
  Real cosine = 1;
  sin_cos(angle, sine, cosine);
  return (cosine * p + sine * cross(axis, p)) + ((Real{1} - cosine) * inner(axis, p)) * axis;
}

/// The angle that turns p to q about the axis, as far as it can (Paden, Kahan: first subproblem).
inline Real angle_between(const Vector& axis, const Vector& p, const Vector& q) {
  return arc_tangent(inner(axis, cross(p, q)), inner(p, q) - inner(axis, p) * inner(axis, q));
}

/// The two angles with h . turned(axis, angle, p) = d; the nearest ones if there are none. `spread` is the least half
/// difference of the two, so that a nearly double root gives values on both sides. Returns the half difference; where there are
/// no angles minus the root of twice what the cosine passes 1 by, which goes on from it as if it were imaginary.
inline Real angles_to_plane(const Vector& h, const Vector& axis, const Vector& p, Real d, Real spread, Real* angle) {
  const Vector side = cross(axis, p);
  const Real a = inner(h, side);
  const Real b = -inner(h, cross(axis, side));
  const Real c = d - inner(h, axis) * inner(axis, p);
  const Real size = square_root(a * a + b * b);
  const Real middle = size > Real{0} ? arc_tangent(a, b) : Real{0};
  const Real cosine = size > Real{0} ? c / size : Real{1};
  const Real half = arc_cosine(cosine);
  constexpr Real straight = Real(3.14159265358979323846);
  Real apart = half < spread ? spread : half;
  if (apart > straight - spread) apart = straight - spread;
  angle[0] = middle + apart;
  angle[1] = middle - apart;
  const Real excess = magnitude(cosine) - Real{1};
  if (excess > Real{0}) return -square_root(Real{2} * excess);
  return half < straight - half ? half : straight - half;
}

/// Whether a branch is out of reach, going by what angles_to_plane() returned: by a fifth of the length that decides, far more
/// than an arm's errors make.
inline bool far_from_root(Real half) { return half < Real(-0.63); }

inline Vector row_of(const Real* r, const Vector& v) {
  return {r[0] * v.x + r[1] * v.y + r[2] * v.z, r[3] * v.x + r[4] * v.y + r[5] * v.z, r[6] * v.x + r[7] * v.y + r[8] * v.z};
}

/// The point between two lines where they are nearest to each other.
inline Vector meeting(const Vector& p, const Vector& u, const Vector& q, const Vector& v) {
  const Real c = inner(u, v);
  const Real determinant = Real{1} - c * c;
  if (!(determinant > Real(1e-3))) return p;
  const Vector w = q - p;
  const Real s = (inner(w, u) - c * inner(w, v)) / determinant;
  const Real t = (c * inner(w, u) - inner(w, v)) / determinant;
  return Real(0.5) * ((p + s * u) + (q + t * v));
}

inline Real line_distance(const Vector& point, const Vector& p, const Vector& u) { return length(cross(point - p, u)); }

/// Reads the screws off the arm at zero readings.
inline void read_screws(const Arm<Real>& arm, Screws& screws) {
  screws.family = ArmFamily::general;
  if (arm.mark != arm_mark<Real> || arm.joint_count != 6 || arm.prismatic_mask != 0U) return;
  const Real zero[max_joints] = {};
  Jacobian<Real> jacobian;
  evaluate_plain(arm, zero, screws.zero, jacobian);
  const Real* p = screws.zero.position_m;
  for (int i = 0; i < 6; ++i) {
    const Real* column = jacobian.column[i];
    const Vector z{column[3], column[4], column[5]};
    const Vector moment{column[0], column[1], column[2]};
    screws.axis[i] = z;
    screws.point[i] = Vector{p[0], p[1], p[2]} - cross(moment, z);
  }
  constexpr Real parallel = Real(0.0872);  // 5 degrees
  const Real near = Real(0.05) * arm.reach_m;
  const Vector* k = screws.axis;
  const Vector* o = screws.point;
  if (length(cross(k[1], k[2])) > parallel || length(cross(k[0], k[1])) < Real(0.5)) return;
  const Vector last = meeting(o[4], k[4], o[5], k[5]);
  const bool meets = length(cross(k[4], k[5])) > Real(0.5) && line_distance(last, o[5], k[5]) < near;
  if (!meets) return;
  screws.meet = last;
  if (length(cross(k[2], k[3])) < parallel && length(cross(k[3], k[4])) > Real(0.5)) {
    screws.family = ArmFamily::parallel_axes;
  } else if (line_distance(last, o[3], k[3]) < near && length(cross(k[3], k[4])) > Real(0.5)) {
    screws.family = ArmFamily::spherical_wrist;
  }
}

/// Starting values for the joint coordinates.
struct StartingValues {
  std::int32_t count;      ///< 0 ... 8
  Real coordinates[8][6];
  Real smallest;           ///< smallest half difference, real or not, of two roots of joints 1 and 3: small near a fold [rad]
  Real wrist_smallest;     ///< that of joint 5: small near a straight wrist [rad]
  Real base_radius_m;      ///< how far the wrist is from axis 1 [m]
};

/// How starting values depart from the pose's own, where the pose alone does not say where a joint is.
struct Departure {
  Real spread;      ///< least half difference of two roots [rad]
  Real base_turn;   ///< added to joint 1 [rad]
  Real wrist_turn;  ///< added to joint 6 and taken back by those before it, as far as a straight wrist allows [rad]
};

/// Both values of joint 3 that bring p, fixed beyond it, as far from axis 2 as `across` is, with those of joint 2 that
/// turn it there (Paden, Kahan: third and first subproblem).
struct Elbow {
  Real second[2], third[2];
  bool far;   ///< out of reach
};

inline Elbow bend_elbow(const Screws& s, const Vector& p, const Vector& across, Real spread, StartingValues& values) {
  const Vector q = s.point[1] - s.point[2];
  Elbow elbow;
  const Real distance = Real(0.5) * (inner(p, p) + inner(q, q) - inner(across, across));
  const Real half = angles_to_plane(q, s.axis[2], p, distance, spread, elbow.third);
  elbow.far = far_from_root(half);
  if (magnitude(half) < values.smallest) values.smallest = magnitude(half);
  for (int i = 0; i < 2; ++i) {
    elbow.second[i] = angle_between(s.axis[1], turned(s.axis[2], elbow.third[i], p) - q, across);
  }
  return elbow;
}

inline void add_value(StartingValues& values, Real c1, Real c2, Real c3, Real c4, Real c5, Real c6) {
  Real* c = values.coordinates[values.count++];
  c[0] = c1;
  c[1] = c2;
  c[2] = c3;
  c[3] = c4;
  c[4] = c5;
  c[5] = c6;
}

inline void closed_form(const Screws& s, const Frame<Real>& target, const Departure& departure, StartingValues& values) {
  const Vector* k = s.axis;
  const Vector* o = s.point;
  // g = target zero^-1: the motion of all six turns.
  Real g[9];
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) g[3 * row + col] = dot(target.rotation + 3 * row, s.zero.rotation + 3 * col);
  }
  const Vector flange{s.zero.position_m[0], s.zero.position_m[1], s.zero.position_m[2]};
  const Vector moved = Vector{target.position_m[0], target.position_m[1], target.position_m[2]} +
                       row_of(g, s.meet - flange);
  const Real gt[9] = {g[0], g[3], g[6], g[1], g[4], g[7], g[2], g[5], g[8]};
  const Vector h = k[1];
  const Real spread = departure.spread;
  values.count = 0;
  values.wrist_smallest = Real{4};
  values.base_radius_m = line_distance(moved, o[0], k[0]);
  Real first[2];
  // Turns about axes along h leave the height along h as it is, so joint 1 alone sets it.
  const Real shoulder = angles_to_plane(h, Real{-1} * k[0], moved - o[0], inner(h, s.meet - o[0]), spread, first);
  values.smallest = magnitude(shoulder);
  const bool exact = !(magnitude(departure.base_turn) + magnitude(departure.wrist_turn) > Real{0});
  if (exact && far_from_root(shoulder)) return;
  for (const Real root : first) {
    const Real c1 = root + departure.base_turn;
    const Vector lowered = o[0] + turned(k[0], -c1, moved - o[0]);
    if (s.family == ArmFamily::parallel_axes) {
      const Vector h_flange = row_of(gt, turned(k[0], c1, h));
      Real fifth[2];
      const Real half = angles_to_plane(h, k[4], k[5], inner(h_flange, k[5]), spread, fifth);
      if (magnitude(half) < values.wrist_smallest) values.wrist_smallest = magnitude(half);
      for (const Real c5 : fifth) {
        const Real c6 = departure.wrist_turn - angle_between(k[5], turned(k[4], -c5, h), h_flange);
        // The sum of turns 2, 3, 4 from what it does to axis 5, which is across h.
        const Vector carried = turned(k[0], -c1, row_of(g, turned(k[5], -c6, k[4])));
        const Real sum = angle_between(h, k[4], carried);
        const Elbow elbow = bend_elbow(s, o[3] - o[2], lowered - turned(h, sum, s.meet - o[3]) - o[1], spread, values);
        for (int i = 0; i < 2 && !(exact && elbow.far); ++i) {
          add_value(values, c1, elbow.second[i], elbow.third[i], sum - elbow.second[i] - elbow.third[i], c5, c6);
        }
      }
      continue;
    }
    const Elbow elbow = bend_elbow(s, s.meet - o[2], lowered - o[1], spread, values);
    for (int i = 0; i < 2 && !(exact && elbow.far); ++i) {
      const Real c2 = elbow.second[i];
      const Real c3 = elbow.third[i];
      const Vector sixth = turned(k[2], -c3, turned(k[1], -c2, turned(k[0], -c1, row_of(g, k[5]))));
      const Vector fourth = row_of(gt, turned(k[0], c1, turned(k[1], c2, turned(k[2], c3, k[3]))));
      Real fifth[2];
      const Real half = angles_to_plane(k[3], k[4], k[5], inner(k[3], sixth), spread, fifth);
      if (magnitude(half) < values.wrist_smallest) values.wrist_smallest = magnitude(half);
      for (const Real c5 : fifth) {
        const Vector bent = turned(k[4], c5, k[5]);
        const Real back = inner(k[3], bent) < Real{0} ? departure.wrist_turn : -departure.wrist_turn;
        const Real c6 = departure.wrist_turn - angle_between(k[5], turned(k[4], -c5, k[3]), fourth);
        add_value(values, c1, c2, c3, back + angle_between(k[3], bent, sixth), c5, c6);
      }
    }
  }
}

}  // namespace
}  // namespace mdhcal
