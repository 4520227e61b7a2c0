// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. A x = b for six joints by Householder QR. Templates write its loops out: at -O2
// GCC unrolls only what becomes smaller, and the loops would cost as much as the arithmetic.
#pragma once

#include "arm/rotation.hpp"
#include "number/real.hpp"

namespace mdhcal {
namespace {

/// The QR factors of a 6 x 6 matrix, column by column: below and on the diagonal the Householder vectors, above it R.
struct Factors {
  Real column[6][6];
  Real inverse_diagonal[6];  ///< of R
  Real scale[6];             ///< 2 / |v|^2 of the Householder vectors
};

/// The sum of a_i b_i over i = k ... 5.
template <int k>
[[gnu::always_inline]] inline Real tail_product(const Real* a, const Real* b) {
  if constexpr (k == 5) {
    return a[5] * b[5];
  } else {
    return a[k] * b[k] + tail_product<k + 1>(a, b);
  }
}

/// to_i -= factor v_i for i = k ... 5.
template <int k>
[[gnu::always_inline]] inline void subtract_tail(Real factor, const Real* v, Real* to) {
  to[k] -= factor * v[k];
  if constexpr (k < 5) subtract_tail<k + 1>(factor, v, to);
}

/// Reflection k of b.
template <int k>
[[gnu::always_inline]] inline void reflect(const Factors& f, Real* b) {
  subtract_tail<k>(f.scale[k] * tail_product<k>(f.column[k], b), f.column[k], b);
}

/// Reflection k of the columns from `column` on.
template <int k, int column>
[[gnu::always_inline]] inline void reflect_columns(Factors& f) {
  if constexpr (column < 6) {
    reflect<k>(f, f.column[column]);
    reflect_columns<k, column + 1>(f);
  }
}

/// Eliminates the columns from k on below the diagonal. Returns false if the matrix is singular. |v|^2 / 2 = -norm v_k: one
/// division gives both reciprocals.
template <int k>
[[gnu::always_inline]] inline bool eliminate(Factors& f) {
  Real* v = f.column[k];
  const Real square = tail_product<k>(v, v);
  if (!(square > Real{0})) return false;
  const Real norm = v[k] > Real{0} ? -square_root(square) : square_root(square);
  v[k] -= norm;
  const Real part = Real{1} / (norm * v[k]);
  f.inverse_diagonal[k] = part * v[k];
  f.scale[k] = -part;
  reflect_columns<k, k + 1>(f);
  if constexpr (k < 5) {
    return eliminate<k + 1>(f);
  } else {
    return true;
  }
}

/// Factors the matrix in place. Returns false if it is singular.
[[gnu::noinline]] bool factor(Factors& f) { return eliminate<0>(f); }

/// `sum` less what x_j ... x_last are in row `row` of R x.
template <int row, int j, int last>
[[gnu::always_inline]] inline Real without(const Factors& f, const Real* x, Real sum) {
  if constexpr (j > last) {
    return sum;
  } else {
    return without<row, j + 1, last>(f, x, sum - f.column[j][row] * x[j]);
  }
}

/// R x = b, x in the place of b, from row `row` up, where x_last is the last that is not zero.
template <int row, int last>
[[gnu::always_inline]] inline void solve_upper(const Factors& f, Real* b) {
  b[row] = f.inverse_diagonal[row] * without<row, row + 1, last>(f, b, b[row]);
  if constexpr (row > 0) solve_upper<row - 1, last>(f, b);
}

/// `sum` less what x_0 ... x_j are in row `row` of R^T x.
template <int row, int j>
[[gnu::always_inline]] inline Real without_above(const Factors& f, const Real* x, Real sum) {
  if constexpr (j < 0) {
    return sum;
  } else {
    return without_above<row, j - 1>(f, x, sum - f.column[row][j] * x[j]);
  }
}

/// R^T x = b, x in the place of b, from row `row` down.
template <int row>
[[gnu::always_inline]] inline void solve_lower(const Factors& f, Real* b) {
  b[row] = f.inverse_diagonal[row] * without_above<row, row - 1>(f, b, b[row]);
  if constexpr (row < 5) solve_lower<row + 1>(f, b);
}

/// Whether the determinant is negative: the six reflections do not change its sign.
inline bool negative_determinant(const Factors& f) {
  bool negative = false;
  for (const Real inverse : f.inverse_diagonal) negative = negative != (inverse < Real{0});
  return negative;
}

/// Whether the inverse is too large to be worked with: its rounding tells no direction, and its squares would overflow in float.
inline bool is_singular(const Factors& f) {
  for (const Real inverse : f.inverse_diagonal) {
    if (magnitude(inverse) > Real(1e7)) return true;
  }
  return false;
}

/// The direction v of length 1 in which |A v| is least: inverse iteration, two rounds. What they leave is the fourth power of
/// the part that the least singular value is of the next.
[[gnu::noinline]] void weakest_direction(const Factors& f, Real* v) {
  // Any start will do that is not orthogonal to what is sought; unlike entries make that unlikely.
  for (int i = 0; i < 6; ++i) v[i] = i % 2 == 0 ? Real{1} : Real(0.7);
  for (int round = 0; round < 2; ++round) {
    solve_lower<0>(f, v);
    solve_upper<5, 5>(f, v);
    const Real scale = Real{1} / square_root(tail_product<0>(v, v));
    for (int i = 0; i < 6; ++i) v[i] *= scale;
  }
}

/// The squares of the columns from k on of R^-1, summed up.
template <int k>
[[gnu::always_inline]] inline Real inverse_squares(const Factors& f) {
  if constexpr (k == 6) {
    return Real{0};
  } else {
    Real x[6] = {};
    x[k] = 1;
    solve_upper<k, k>(f, x);
    return tail_product<0>(x, x) + inverse_squares<k + 1>(f);
  }
}

/// A lower bound of the smallest singular value, 1 / |R^-1|_F, which is at most sqrt(6) below it.
[[gnu::noinline]] Real singular_bound(const Factors& f) { return Real{1} / square_root(inverse_squares<0>(f)); }

/// A x = b, x in the place of b.
[[gnu::noinline]] void solve(const Factors& f, Real* b) {
  reflect<0>(f, b);
  reflect<1>(f, b);
  reflect<2>(f, b);
  reflect<3>(f, b);
  reflect<4>(f, b);
  reflect<5>(f, b);
  solve_upper<5, 5>(f, b);
}

}  // namespace
}  // namespace mdhcal
