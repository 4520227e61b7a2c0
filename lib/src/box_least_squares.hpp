// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. Damped linear least squares within bounds.
#pragma once

#include "mdhcal/geometry.hpp"
#include "real.hpp"
#include "rotation.hpp"

namespace mdhcal {
namespace {

/// minimise |b - A x|^2 + damping^2 |pull - x|^2 over low <= x <= high, where low <= 0 <= high.
struct BoxProblem {
  std::int32_t rows;      ///< of A, at most seven: six of a pose and one that holds a singular value
  std::int32_t columns;   ///< of A, at most max_joints
  Real row[7][max_joints];
  Real b[7];
  Real damping;           ///< > 0
  Real pull[max_joints];
  Real low[max_joints], high[max_joints];
};

inline bool has(std::uint32_t mask, std::int32_t j) { return ((mask >> static_cast<std::uint32_t>(j)) & 1U) != 0U; }

/// An upper triangular system R x = b, kept triangular while equations are added one at a time.
struct Triangle {
  std::int32_t size;
  Real entry[max_joints * (max_joints + 1) / 2];   ///< R by rows
  Real b[max_joints];

  Real* row(std::int32_t i) { return entry + (i * size - i * (i + 1) / 2); }   ///< row(i)[j] is R_ij, j >= i
};

/// R = diagonal times the unit matrix.
inline void start(Triangle& triangle, std::int32_t size, Real diagonal) {
  triangle.size = size;
  for (std::int32_t i = 0; i < size; ++i) {
    Real* row = triangle.row(i);
    row[i] = diagonal;
    for (std::int32_t j = i + 1; j < size; ++j) row[j] = 0;
    triangle.b[i] = 0;
  }
}

/// Adds the equation r . x = b by Givens rotations (Golub, Van Loan 2013, 5.1.8 and 6.5.2). r is overwritten.
inline void add_equation(Triangle& triangle, Real* r, Real b) {
  for (std::int32_t k = 0; k < triangle.size; ++k) {
    if (!(magnitude(r[k]) > Real{0})) continue;
    Real* row = triangle.row(k);
    // Of squares that vanish in rounding nothing is to be rotated either.
    const Real norm = square_root(row[k] * row[k] + r[k] * r[k]);
    if (!(norm > Real{0})) continue;
    const Real cosine = row[k] / norm;
    const Real sine = r[k] / norm;
    row[k] = norm;
    for (std::int32_t j = k + 1; j < triangle.size; ++j) {
      const Real x = row[j];
      row[j] = cosine * x + sine * r[j];
      r[j] = cosine * r[j] - sine * x;
    }
    const Real x = triangle.b[k];
    triangle.b[k] = cosine * x + sine * b;
    b = cosine * b - sine * x;
  }
}

inline void solve_upper(Triangle& triangle, const Real* b, Real* x) {
  for (std::int32_t i = triangle.size - 1; i >= 0; --i) {
    const Real* row = triangle.row(i);
    Real sum = b[i];
    for (std::int32_t j = i + 1; j < triangle.size; ++j) sum -= row[j] * x[j];
    x[i] = sum / row[i];
  }
}

/// What x leaves of b in equation i.
inline Real residual(const BoxProblem& problem, std::int32_t i, const Real* x) {
  Real left = problem.b[i];
  for (std::int32_t j = 0; j < problem.columns; ++j) left -= problem.row[i][j] * x[j];
  return left;
}

/// The minimum over the unknowns in `free_mask`, the others at x; into `z`, in the order of the free ones.
[[gnu::noinline]] void solve_free(const BoxProblem& problem, std::uint32_t free_mask, const Real* x, Real* z) {
  Triangle triangle;
  std::int32_t size = 0;
  for (std::int32_t j = 0; j < problem.columns; ++j) size += has(free_mask, j) ? 1 : 0;
  // The damping's equations are triangular as they stand.
  start(triangle, size, problem.damping);
  std::int32_t k = 0;
  for (std::int32_t j = 0; j < problem.columns; ++j) {
    if (has(free_mask, j)) triangle.b[k++] = problem.damping * problem.pull[j];
  }
  for (std::int32_t i = 0; i < problem.rows; ++i) {
    Real r[max_joints];
    Real b = problem.b[i];
    k = 0;
    for (std::int32_t j = 0; j < problem.columns; ++j) {
      if (has(free_mask, j)) {
        r[k++] = problem.row[i][j];
      } else {
        b -= problem.row[i][j] * x[j];
      }
    }
    add_equation(triangle, r, b);
  }
  solve_upper(triangle, triangle.b, z);
}

/// Goes from x towards z (the free unknowns' values) as far as the bounds let it. Returns the unknown that met a bound
/// first and now rests on it, or -1.
inline std::int32_t advance(const BoxProblem& problem, std::uint32_t free_mask, const Real* z, Real* x) {
  Real part = 1;
  std::int32_t hit = -1;
  std::int32_t k = 0;
  for (std::int32_t j = 0; j < problem.columns; ++j) {
    if (!has(free_mask, j)) continue;
    const Real to = z[k++];
    if (!(to > problem.high[j]) && !(to < problem.low[j])) continue;
    const Real room = to > x[j] ? problem.high[j] - x[j] : problem.low[j] - x[j];
    const Real ratio = room / (to - x[j]);
    if (hit < 0 || ratio < part) {
      part = ratio;
      hit = j;
    }
  }
  k = 0;
  for (std::int32_t j = 0; j < problem.columns; ++j) {
    if (!has(free_mask, j)) continue;
    const Real to = z[k++];
    const Real next = hit >= 0 ? x[j] + part * (to - x[j]) : to;
    const bool up = j == hit ? to > x[j] : next > problem.high[j];
    const bool down = j == hit ? !up : next < problem.low[j];
    x[j] = up ? problem.high[j] : (down ? problem.low[j] : next);
  }
  return hit;
}

/// Solves the problem by an active set (Lawson, Hanson 1974, ch. 23; Stark, Parker 1995): each round either meets a
/// bound, which then holds, or lets go of the one that the residual pulls away from the hardest. The objective falls in
/// every round, so x is usable at the bound of rounds too.
[[gnu::noinline]] void solve(const BoxProblem& problem, Real* x) {
  std::uint32_t movable = 0;
  for (std::int32_t j = 0; j < problem.columns; ++j) {
    x[j] = 0;
    if (problem.high[j] > problem.low[j]) movable |= 1U << static_cast<std::uint32_t>(j);
  }
  std::uint32_t free_mask = movable;
  for (std::int32_t round = 0; round < 3 * problem.columns; ++round) {
    Real z[max_joints];
    solve_free(problem, free_mask, x, z);
    const std::int32_t hit = advance(problem, free_mask, z, x);
    if (hit >= 0) {
      free_mask &= ~(1U << static_cast<std::uint32_t>(hit));
      continue;
    }
    if (free_mask == movable) break;
    Real slope[max_joints];
    for (std::int32_t j = 0; j < problem.columns; ++j) {
      slope[j] = problem.damping * problem.damping * (problem.pull[j] - x[j]);
    }
    for (std::int32_t i = 0; i < problem.rows; ++i) {
      const Real left = residual(problem, i, x);
      for (std::int32_t j = 0; j < problem.columns; ++j) slope[j] += problem.row[i][j] * left;
    }
    Real hardest = 0;
    std::int32_t release = -1;
    for (std::int32_t j = 0; j < problem.columns; ++j) {
      if (!has(movable & ~free_mask, j)) continue;
      const Real inward = x[j] < problem.high[j] ? slope[j] : -slope[j];
      if (inward > hardest) {
        hardest = inward;
        release = j;
      }
    }
    if (release < 0) break;
    free_mask |= 1U << static_cast<std::uint32_t>(release);
  }
}

}  // namespace
}  // namespace mdhcal
