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

/// The matrix of the least-squares problem of damping x = right over A x = b, and in its place the triangle R that
/// factor() makes of it.
struct Stack {
  std::int32_t size;        ///< unknowns
  std::int32_t equations;   ///< of A, at most max_joints
  Real column[max_joints][max_joints];   ///< of A; then [i][j - 1] is R_ij, j > i
  Real diagonal[max_joints];             ///< of R
};

/// Reflection i takes column i of A into row i of the damping, which is zero right of its diagonal (Householder 1958).
/// Makes R x = right of the right-hand sides too, where they are given.
inline void factor(Stack& stack, Real damping, Real* right, Real* b) {
  const std::int32_t equations = stack.equations;
  for (std::int32_t i = 0; i < stack.size; ++i) {
    Real v[max_joints];
    Real square = damping * damping;
    for (std::int32_t k = 0; k < equations; ++k) {
      v[k] = stack.column[i][k];
      square += v[k] * v[k];
    }
    const Real norm = square_root(square);
    const Real head = damping + norm;
    const Real scale = Real{1} / (norm * head);
    stack.diagonal[i] = -norm;
    for (std::int32_t j = i + 1; j < stack.size; ++j) {
      Real* to = stack.column[j];
      Real sum = 0;
      for (std::int32_t k = 0; k < equations; ++k) sum += v[k] * to[k];
      sum *= scale;
      for (std::int32_t k = 0; k < equations; ++k) to[k] -= sum * v[k];
      stack.column[i][j - 1] = -sum * head;
    }
    if (b == nullptr) continue;
    Real sum = head * right[i];
    for (std::int32_t k = 0; k < equations; ++k) sum += v[k] * b[k];
    sum *= scale;
    for (std::int32_t k = 0; k < equations; ++k) b[k] -= sum * v[k];
    right[i] -= sum * head;
  }
}

/// R x = b; x may be b.
inline void solve_upper(const Stack& stack, const Real* b, Real* x) {
  for (std::int32_t i = stack.size - 1; i >= 0; --i) {
    const Real* row = stack.column[i];
    Real sum = b[i];
    for (std::int32_t j = i + 1; j < stack.size; ++j) sum -= row[j - 1] * x[j];
    x[i] = sum / stack.diagonal[i];
  }
}

/// R^T x = b; x may be b.
inline void solve_lower(const Stack& stack, const Real* b, Real* x) {
  for (std::int32_t i = 0; i < stack.size; ++i) {
    Real sum = b[i];
    for (std::int32_t j = 0; j < i; ++j) sum -= stack.column[j][i - 1] * x[j];
    x[i] = sum / stack.diagonal[i];
  }
}

/// What x leaves of b in equation i.
inline Real residual(const BoxProblem& problem, std::int32_t i, const Real* x) {
  Real left = problem.b[i];
  for (std::int32_t j = 0; j < problem.columns; ++j) left -= problem.row[i][j] * x[j];
  return left;
}

/// Minus half the slope of |b - A x|^2 by x_j at 0.
inline Real slope_of(const BoxProblem& problem, std::int32_t j) {
  Real sum = 0;
  for (std::int32_t i = 0; i < problem.rows; ++i) sum += problem.row[i][j] * problem.b[i];
  return sum;
}

/// The minimum over the unknowns in `free_mask`, the others at x; into `z`, in the order of the free ones.
[[gnu::noinline]] void solve_free(const BoxProblem& problem, std::uint32_t free_mask, const Real* x, Real* z) {
  Stack stack;
  Real right[max_joints];
  Real b[7];
  stack.equations = problem.rows;
  for (std::int32_t i = 0; i < problem.rows; ++i) b[i] = problem.b[i];
  std::int32_t size = 0;
  for (std::int32_t j = 0; j < problem.columns; ++j) {
    if (has(free_mask, j)) {
      for (std::int32_t i = 0; i < problem.rows; ++i) stack.column[size][i] = problem.row[i][j];
      right[size++] = problem.damping * problem.pull[j];
    } else {
      for (std::int32_t i = 0; i < problem.rows; ++i) b[i] -= problem.row[i][j] * x[j];
    }
  }
  stack.size = size;
  factor(stack, problem.damping, right, b);
  solve_upper(stack, right, z);
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
