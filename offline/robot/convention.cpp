// SPDX-License-Identifier: MIT
#include "offline/robot/convention.hpp"

#include <cmath>

namespace mdhcal::offline {

namespace {

// Standard tables with nearly parallel axes hold lengths of hundreds of metres that cancel: long double where the
// machine has it.
using Real = long double;
using Vector = std::array<Real, 3>;

struct Transform {
  std::array<Vector, 3> axis{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // the columns of the rotation
  Vector position{};
};

Real dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// a + factor b
Vector sum(const Vector& a, Real factor, const Vector& b) {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}

Real norm(const Vector& a) { return std::sqrt(dot(a, a)); }

Vector scaled(const Vector& a, Real factor) { return {factor * a[0], factor * a[1], factor * a[2]}; }

Vector rotate(const Transform& t, const Vector& v) {
  return sum(sum(scaled(t.axis[0], v[0]), v[1], t.axis[1]), v[2], t.axis[2]);
}

Transform operator*(const Transform& a, const Transform& b) {
  Transform c;
  for (std::size_t k = 0; k < 3; ++k) c.axis[k] = rotate(a, b.axis[k]);
  c.position = sum(a.position, 1, rotate(a, b.position));
  return c;
}

Transform inverse(const Transform& t) {
  Transform out;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t col = 0; col < 3; ++col) out.axis[col][row] = t.axis[row][col];
  }
  out.position = scaled(rotate(out, t.position), -1);
  return out;
}

Transform screw_z(Real theta, Real d) {
  const Real s = std::sin(theta), c = std::cos(theta);
  return {{{{c, s, 0}, {-s, c, 0}, {0, 0, 1}}}, {0, 0, d}};
}

Transform screw_x(Real alpha, Real a) {
  const Real s = std::sin(alpha), c = std::cos(alpha);
  return {{{{1, 0, 0}, {0, c, s}, {0, -s, c}}}, {a, 0, 0}};
}

Transform from_frame(const Frame<double>& frame) {
  Transform t;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t col = 0; col < 3; ++col) t.axis[col][row] = static_cast<Real>(frame.rotation[3 * row + col]);
    t.position[row] = static_cast<Real>(frame.position_m[row]);
  }
  return t;
}

Frame<double> to_frame(const Transform& t) {
  Frame<double> frame{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t col = 0; col < 3; ++col) frame.rotation[3 * row + col] = static_cast<double>(t.axis[col][row]);
    frame.position_m[row] = static_cast<double>(t.position[row]);
  }
  return frame;
}

Real wrapped(Real angle) { return std::remainder(angle, 2 * std::acos(Real{-1})); }

// Rot_z(theta) Trans_z(d) Rot_y(beta) Rot_x(alpha) Trans_x(a) Rot_z(next_theta) Trans_z(next_d)
struct Split {
  Real theta = 0, d = 0, beta = 0, alpha = 0, a = 0, next_theta = 0, next_d = 0;
};

Real nearly_parallel_sine() { return std::sin(static_cast<Real>(nearly_parallel_rad)); }

// Of the two directions of x the one nearer to `wanted`; where neither is within 60 degrees of it, the one nearer to
// theta = 0.
Vector oriented(const Vector& x, const Vector& wanted) {
  const Real along = dot(x, wanted);
  const bool forward = std::abs(along) > Real{0.5L} ? along > 0 : x[0] > 0 || (!(x[0] < 0) && x[1] > 0);
  return forward ? x : scaled(x, -1);
}

// Splits the transform between two neighbouring joints' z axes. `wanted`: the direction that x'' should rather have.
Split split(const Transform& g, const Vector& wanted) {
  const Vector z{0, 0, 1};
  const Vector& u = g.axis[2];
  const Vector normal = cross(z, u);
  const Real sine = norm(normal);
  Split s;
  Vector x;
  if (sine > nearly_parallel_sine()) {
    // The common normal meets axis i at (0, 0, d) and axis i+1 at p + t u.
    x = oriented(scaled(normal, 1 / sine), wanted);
    // p = d z + a x + t u, times u x (z x u), to which x and u are orthogonal and whose product with z is sine^2.
    s.d = dot(g.position, cross(u, normal)) / (sine * sine);
  } else {
    const Vector foot = sum(g.position, -dot(u, g.position), u);
    const Real length = norm(foot);
    // Axis i+1 passes through the origin: any direction across it will do.
    x = length > Real{1e-13L} ? oriented(scaled(foot, 1 / length), wanted) : wanted;
    // Once more: the rounding of a short foot is not small against its length.
    x = sum(x, -dot(u, x), u);
    x = scaled(x, 1 / norm(x));
    s.beta = -std::asin(x[2]);
  }
  const Vector offset = sum(g.position, -s.d, z);
  s.theta = std::atan2(x[1], x[0]);
  s.a = dot(offset, x);
  s.next_d = dot(offset, u);
  // y'' = Rot_z(theta) Rot_y(beta) e_y lies in the plane of axis i's x and y; u = (0, -sin alpha, cos alpha) there.
  const Vector y{-std::sin(s.theta), std::cos(s.theta), 0};
  const Vector w = cross(x, y);
  s.alpha = std::atan2(-dot(u, y), dot(u, w));
  // g's x axis in the frame after Rot_x(alpha), whose y axis is u cross x.
  s.next_theta = std::atan2(dot(g.axis[0], cross(u, x)), dot(g.axis[0], x));
  return s;
}

// Link i of the result takes alpha and a from the split before it, theta and d from the one after.
struct Builder {
  ModifiedChain chain;
  Split before;

  void append(const Split& after) {
    Link link{};
    link.alpha_rad = static_cast<double>(before.alpha);
    link.a_m = static_cast<double>(before.a);
    link.theta_rad = static_cast<double>(after.theta);
    link.d_m = static_cast<double>(after.d);
    link.beta_rad = static_cast<double>(after.beta);
    chain.links.push_back(link);
    before = after;
  }
};

// The least motion that brings axis 1 from where link 1 can express it to where it is. Rot_x(alpha) Trans_x(a) Rot_z Trans_z
// reaches the axes through (a, 0, 0) across x: what is left is a tilt about y'' = Rot_x(alpha) e_y and a shift along it.
Transform origin_of(const Transform& first) {
  constexpr Real tolerance = Real{1e-12L};
  const Vector& u = first.axis[2];
  const Real across = std::hypot(u[1], u[2]);
  // Nearly along x, alpha is not defined: the base frame then lies on the axis itself.
  if (across < Real{0.5L}) return first;
  const Vector x{1, 0, 0};
  const Vector w{0, u[1] / across, u[2] / across};
  const Vector y = cross(w, x);
  const Real shift = dot(first.position, y);
  Transform origin;
  if (std::abs(u[0]) <= tolerance && std::abs(shift) <= tolerance) return origin;
  for (std::size_t k = 0; k < 3; ++k) {
    // Each unit vector turned about y by the angle of sine u_x and cosine `across`, which takes w to u.
    Vector e{};
    e[k] = 1;
    const Real along_x = dot(e, x) * across + dot(e, w) * u[0];
    const Real along_w = dot(e, w) * across - dot(e, x) * u[0];
    origin.axis[k] = sum(sum(scaled(x, along_x), dot(e, y), y), along_w, w);
  }
  // The joint's own origin moves by the shift alone.
  origin.position = sum(first.position, -1, rotate(origin, sum(first.position, -shift, y)));
  return origin;
}

}  // namespace

ModifiedChain mdh_from_chain(std::span<const Frame<double>> fixed) {
  Builder builder;
  Transform first = from_frame(fixed[0]);
  const Transform origin = origin_of(first);
  first = inverse(origin) * first;
  const Vector& u = first.axis[2];
  const Real alpha = std::atan2(-u[1], u[2]);
  const Vector y{0, std::cos(alpha), std::sin(alpha)};
  builder.before.alpha = alpha;
  builder.before.a = first.position[0];
  builder.before.next_d = dot(first.position, u);
  builder.before.next_theta = std::atan2(dot(first.axis[0], y), first.axis[0][0]);
  const std::size_t count = fixed.size() - 1;
  for (std::size_t i = 1; i < count; ++i) {
    const Transform turn = screw_z(builder.before.next_theta, builder.before.next_d);
    builder.append(split(turn * from_frame(fixed[i]), {1, 0, 0}));
  }
  Split last;
  last.theta = builder.before.next_theta;
  last.d = builder.before.next_d;
  builder.append(last);
  builder.chain.last_T_flange = fixed[count];
  builder.chain.origin = to_frame(origin);
  return builder.chain;
}

ModifiedChain mdh_from_standard(std::span<const StandardLink> table) {
  // Below this an angle between axes is the rounding of 0 or 180 degrees.
  constexpr Real exactly_parallel_sine = Real{1e-9L};
  Builder builder;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const StandardLink& link = table[i];
    Split s;
    s.theta = static_cast<Real>(link.theta_rad) + builder.before.next_theta;
    s.d = static_cast<Real>(link.d_m) + builder.before.next_d;
    s.alpha = static_cast<Real>(link.alpha_rad);
    s.a = static_cast<Real>(link.a_m);
    const Real sine = std::abs(std::sin(s.alpha));
    const bool last = i + 1 == table.size();
    if (!last && sine > exactly_parallel_sine && sine <= nearly_parallel_sine()) {
      const Vector wanted{std::cos(s.theta), std::sin(s.theta), 0};
      s = split(screw_z(s.theta, s.d) * screw_x(s.alpha, s.a), wanted);
    } else if (std::abs(builder.before.next_theta) > 0) {
      s.theta = wrapped(s.theta);
    }
    if (last) builder.chain.last_T_flange = to_frame(screw_x(s.alpha, s.a));
    builder.append(s);
  }
  builder.chain.origin = to_frame(Transform{});
  return builder.chain;
}

}  // namespace mdhcal::offline
