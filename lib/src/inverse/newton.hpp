// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. The regular step of a six-joint arm: J dq = e by Householder QR.
#pragma once

#include "number/real.hpp"
#include "arm/rotation.hpp"

namespace mdhcal {
namespace {

/// The QR factors of a 6 x 6 matrix, column by column: below and on the diagonal the Householder vectors, above it R.
struct Factors {
  Real column[6][6];
  Real diagonal[6];   ///< of R
};

/// 2 / |v|^2 of Householder vector k, since |v|^2 / 2 = -norm v_k.
inline Real reflection_scale(const Factors& f, int k) { return Real{-1} / (f.diagonal[k] * f.column[k][k]); }

/// Factors the matrix in place. Returns false if it is singular.
inline bool factor(Factors& f) {
  for (int k = 0; k < 6; ++k) {
    Real* v = f.column[k];
    Real square = 0;
    for (int i = k; i < 6; ++i) square += v[i] * v[i];
    if (!(square > Real{0})) return false;
    const Real norm = v[k] > Real{0} ? -square_root(square) : square_root(square);
    f.diagonal[k] = norm;
    v[k] -= norm;
    const Real scale = reflection_scale(f, k);
    for (int j = k + 1; j < 6; ++j) {
      Real* c = f.column[j];
      Real sum = 0;
      for (int i = k; i < 6; ++i) sum += v[i] * c[i];
      sum *= scale;
      for (int i = k; i < 6; ++i) c[i] -= sum * v[i];
    }
  }
  return true;
}

/// A lower bound of the smallest singular value, 1 / |R^-1|_F, which is at most sqrt(6) below it.
inline Real singular_bound(const Factors& f) {
  Real frobenius = 0;
  for (int k = 0; k < 6; ++k) {
    // Column k of R^-1 by back substitution.
    Real x[6];
    x[k] = Real{1} / f.diagonal[k];
    frobenius += x[k] * x[k];
    for (int i = k - 1; i >= 0; --i) {
      Real sum = 0;
      for (int j = i + 1; j <= k; ++j) sum += f.column[j][i] * x[j];
      x[i] = -sum / f.diagonal[i];
      frobenius += x[i] * x[i];
    }
  }
  return Real{1} / square_root(frobenius);
}

/// x = A^-1 b; b is overwritten.
inline void solve(const Factors& f, Real* b, Real* x) {
  for (int k = 0; k < 6; ++k) {
    const Real* v = f.column[k];
    Real sum = 0;
    for (int i = k; i < 6; ++i) sum += v[i] * b[i];
    sum *= reflection_scale(f, k);
    for (int i = k; i < 6; ++i) b[i] -= sum * v[i];
  }
  for (int i = 5; i >= 0; --i) {
    Real sum = b[i];
    for (int j = i + 1; j < 6; ++j) sum -= f.column[j][i] * x[j];
    x[i] = sum / f.diagonal[i];
  }
}

}  // namespace
}  // namespace mdhcal
