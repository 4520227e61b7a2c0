// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. Vectors of three by value, which the compiler keeps in registers.
#pragma once

#include "arm/rotation.hpp"
#include "number/real.hpp"

namespace mdhcal {
namespace {

struct Vector {
  Real x, y, z;
};

inline Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vector operator*(Real s, const Vector& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Real inner(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Real length(const Vector& a) { return square_root(inner(a, a)); }

}  // namespace
}  // namespace mdhcal
