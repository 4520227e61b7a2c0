// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. Singular values of a matrix of up to max_joints columns of six.
#pragma once

#include "mdhcal/geometry.hpp"
#include "number/real.hpp"
#include "arm/rotation.hpp"

namespace mdhcal {
namespace {

/// A V = U S, singular values in descending order.
struct SingularBasis {
  Real us[max_joints][6];            ///< column k: s_k u_k; on entry the columns of A
  Real v[max_joints][max_joints];    ///< row k: right singular vector k
  Real s[max_joints];
};

inline Real dot6(const Real* a, const Real* b) {
  return ((a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])) + (a[4] * b[4] + a[5] * b[5]);
}

inline void rotate(Real* a, Real* b, std::int32_t length, Real cosine, Real sine) {
  for (std::int32_t k = 0; k < length; ++k) {
    const Real x = a[k];
    a[k] = cosine * x - sine * b[k];
    b[k] = sine * x + cosine * b[k];
  }
}

/// One-sided Jacobi rotations (Hestenes 1958; Demmel, Veselic 1992: small singular values come out with relative
/// accuracy). At most `sweeps` sweeps; a matrix of this size has converged after five or six.
[[gnu::noinline]] void decompose(SingularBasis& basis, std::int32_t columns) {
  constexpr Real epsilon = sizeof(Real) == sizeof(double) ? Real(1e-15) : Real(3e-7);
  constexpr int sweeps = 12;
  for (std::int32_t i = 0; i < columns; ++i) {
    for (std::int32_t j = 0; j < columns; ++j) basis.v[i][j] = i == j ? Real{1} : Real{0};
  }
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    bool rotated = false;
    for (std::int32_t p = 0; p + 1 < columns; ++p) {
      for (std::int32_t q = p + 1; q < columns; ++q) {
        const Real alpha = dot6(basis.us[p], basis.us[p]);
        const Real beta = dot6(basis.us[q], basis.us[q]);
        const Real gamma = dot6(basis.us[p], basis.us[q]);
        if (!(gamma * gamma > epsilon * epsilon * alpha * beta)) continue;
        rotated = true;
        const Real zeta = (beta - alpha) / (gamma + gamma);
        const Real tangent = (zeta < Real{0} ? Real{-1} : Real{1}) / (magnitude(zeta) + square_root(Real{1} + zeta * zeta));
        const Real cosine = Real{1} / square_root(Real{1} + tangent * tangent);
        rotate(basis.us[p], basis.us[q], 6, cosine, cosine * tangent);
        rotate(basis.v[p], basis.v[q], columns, cosine, cosine * tangent);
      }
    }
    if (!rotated) break;
  }
  for (std::int32_t k = 0; k < columns; ++k) basis.s[k] = square_root(dot6(basis.us[k], basis.us[k]));
  for (std::int32_t k = 0; k + 1 < columns; ++k) {
    std::int32_t largest = k;
    for (std::int32_t i = k + 1; i < columns; ++i) {
      if (basis.s[i] > basis.s[largest]) largest = i;
    }
    if (largest == k) continue;
    const Real s = basis.s[k];
    basis.s[k] = basis.s[largest];
    basis.s[largest] = s;
    rotate(basis.us[k], basis.us[largest], 6, Real{0}, Real{1});
    rotate(basis.v[k], basis.v[largest], columns, Real{0}, Real{1});
  }
}

}  // namespace
}  // namespace mdhcal
