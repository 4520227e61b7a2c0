// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. Damped linear least squares within bounds.
#pragma once

#include "mdhcal/geometry.hpp"
#include "number/real.hpp"
#include "arm/rotation.hpp"

namespace mdhcal {
namespace {

/// Equations of the largest problem: six of a pose, and one that holds a direction.
constexpr std::int32_t max_equations = 7;

/// minimise |b - A x|^2 + damping^2 |pull - x|^2
struct BoxProblem {
  std::int32_t rows;      ///< of A, at most max_equations; fewer than six are filled up with zeros to six
  std::int32_t columns;   ///< of A, at most max_joints
  Real column[max_joints][max_equations];
  Real b[max_equations];
  Real damping;           ///< > 0
  std::int32_t budget;    ///< what is left of the tick's work, in thirds of a factorization
};

/// over low <= x <= high, where low <= 0 <= high.
struct Box {
  Real low[max_joints], high[max_joints];
  Real pull[max_joints];
};

inline bool has(std::uint32_t mask, std::int32_t j) { return ((mask >> static_cast<std::uint32_t>(j)) & 1U) != 0U; }

/// The product of two vectors of six numbers or more: six are spelled out, as most problems have so many equations.
inline Real product(const Real* a, const Real* b, std::int32_t count) {
  Real sum = ((((a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]) + a[3] * b[3]) + a[4] * b[4]) + a[5] * b[5];
  for (std::int32_t k = 6; k < count; ++k) sum += a[k] * b[k];
  return sum;
}

/// to -= factor * v, likewise.
inline void subtract(Real factor, const Real* v, Real* to, std::int32_t count) {
  to[0] -= factor * v[0];
  to[1] -= factor * v[1];
  to[2] -= factor * v[2];
  to[3] -= factor * v[3];
  to[4] -= factor * v[4];
  to[5] -= factor * v[5];
  for (std::int32_t k = 6; k < count; ++k) to[k] -= factor * v[k];
}

/// The equations that are worked on: no fewer than six.
inline std::int32_t equations_of(const BoxProblem& problem) { return problem.rows > 6 ? problem.rows : 6; }

/// The matrix of the least-squares problem of damping x = right over A x = b, and in its place the triangle R that
/// factor() makes of it.
struct Stack {
  std::int32_t size;        ///< unknowns
  std::int32_t equations;   ///< of A, six to max_joints
  Real column[max_joints][max_joints];   ///< of A; then [i][j - 1] is R_ij, j > i
  Real diagonal[max_joints];             ///< of R
};

/// Reflection i takes column i of A into row i of the damping, which is zero right of its diagonal (Householder 1958).
/// Makes R x = right of the right-hand sides too, where they are given.
inline void factor(Stack& stack, Real damping, Real* right, Real* b) {
  const std::int32_t equations = stack.equations;
  for (std::int32_t i = 0; i < stack.size; ++i) {
    Real v[max_joints];
    for (std::int32_t k = 0; k < equations; ++k) v[k] = stack.column[i][k];
    const Real norm = square_root(damping * damping + product(v, v, equations));
    const Real head = damping + norm;
    const Real scale = Real{1} / (norm * head);
    stack.diagonal[i] = -norm;
    for (std::int32_t j = i + 1; j < stack.size; ++j) {
      const Real sum = scale * product(v, stack.column[j], equations);
      subtract(sum, v, stack.column[j], equations);
      stack.column[i][j - 1] = -sum * head;
    }
    if (b == nullptr) continue;
    const Real sum = scale * (head * right[i] + product(v, b, equations));
    subtract(sum, v, b, equations);
    right[i] -= sum * head;
  }
}

/// `sum` less what x_j ... x_5 are in row `row` of R x.
template <int row, int j>
[[gnu::always_inline]] inline Real without_right(const Stack& stack, const Real* x, Real sum) {
  if constexpr (j > 5) {
    return sum;
  } else {
    return without_right<row, j + 1>(stack, x, sum - stack.column[row][j - 1] * x[j]);
  }
}

/// R x = b for six unknowns, written out, from row `row` up.
template <int row>
[[gnu::always_inline]] inline void solve_six_upper(const Stack& stack, const Real* b, Real* x) {
  x[row] = without_right<row, row + 1>(stack, x, b[row]) / stack.diagonal[row];
  if constexpr (row > 0) solve_six_upper<row - 1>(stack, b, x);
}

/// `sum` less what x_j ... x_{row - 1} are in row `row` of R^T x.
template <int row, int j>
[[gnu::always_inline]] inline Real without_left(const Stack& stack, const Real* x, Real sum) {
  if constexpr (j == row) {
    return sum;
  } else {
    return without_left<row, j + 1>(stack, x, sum - stack.column[j][row - 1] * x[j]);
  }
}

/// R^T x = b for six unknowns, written out, from row `row` down.
template <int row>
[[gnu::always_inline]] inline void solve_six_lower(const Stack& stack, const Real* b, Real* x) {
  x[row] = without_left<row, 0>(stack, x, b[row]) / stack.diagonal[row];
  if constexpr (row < 5) solve_six_lower<row + 1>(stack, b, x);
}

/// R x = b; x may be b.
[[gnu::noinline]] void solve_upper(const Stack& stack, const Real* b, Real* x) {
  if (stack.size == 6) return solve_six_upper<5>(stack, b, x);
  for (std::int32_t i = stack.size - 1; i >= 0; --i) {
    const Real* row = stack.column[i];
    Real sum = b[i];
    for (std::int32_t j = i + 1; j < stack.size; ++j) sum -= row[j - 1] * x[j];
    x[i] = sum / stack.diagonal[i];
  }
}

/// R^T x = b; x may be b.
[[maybe_unused, gnu::noinline]] void solve_lower(const Stack& stack, const Real* b, Real* x) {
  if (stack.size == 6) return solve_six_lower<0>(stack, b, x);
  for (std::int32_t i = 0; i < stack.size; ++i) {
    Real sum = b[i];
    for (std::int32_t j = 0; j < i; ++j) sum -= stack.column[j][i - 1] * x[j];
    x[i] = sum / stack.diagonal[i];
  }
}

/// y -= A x
inline void take_all(const BoxProblem& problem, const Real* x, Real* y) {
  const std::int32_t equations = equations_of(problem);
  for (std::int32_t j = 0; j < problem.columns; ++j) subtract(x[j], problem.column[j], y, equations);
}

/// Factors the problem over the unknowns in `free_mask`, the others (if any) at x, and makes R z = right of it for the
/// free ones, in their order. No `pull`: to 0.
inline void factor_free(BoxProblem& problem, const Real* pull, std::uint32_t free_mask, const Real* x, Stack& stack,
                        Real* right) {
  Real b[max_joints];  // as long as what factor() takes
  const std::int32_t equations = equations_of(problem);
  stack.equations = equations;
  for (std::int32_t i = 0; i < equations; ++i) b[i] = problem.b[i];
  std::int32_t size = 0;
  for (std::int32_t j = 0; j < problem.columns; ++j) {
    if (has(free_mask, j)) {
      for (std::int32_t i = 0; i < equations; ++i) stack.column[size][i] = problem.column[j][i];
      right[size++] = pull != nullptr ? problem.damping * pull[j] : Real{0};
    } else {
      subtract(x[j], problem.column[j], b, equations);
    }
  }
  stack.size = size;
  factor(stack, problem.damping, right, b);
  problem.budget -= 3;
}

/// The minimum over all unknowns, free of bounds, of the problem that pulls to 0.
[[maybe_unused, gnu::noinline]] void solve_free(BoxProblem& problem, Real* x) {
  Stack stack;
  Real right[max_joints];
  factor_free(problem, nullptr, (1U << static_cast<std::uint32_t>(problem.columns)) - 1U, nullptr, stack, right);
  solve_upper(stack, right, x);
}

/// Holds unknown p of R z = right at `value`: its column leaves R, and rotations of neighbouring rows make the rest a
/// triangle again (Golub, Van Loan 2013, sec. 6.5.2).
[[gnu::noinline]] void hold(Stack& stack, Real* right, std::int32_t p, Real value) {
  const std::int32_t last = stack.size - 1;
  for (std::int32_t i = 0; i < p; ++i) {
    Real* row = stack.column[i];
    right[i] -= row[p - 1] * value;
    for (std::int32_t j = p; j < last; ++j) row[j - 1] = row[j];
  }
  Real upper[max_joints];   // what is left of the row above, from the diagonal on
  for (std::int32_t j = p; j < last; ++j) upper[j] = stack.column[p][j];
  Real above = right[p] - stack.diagonal[p] * value;
  for (std::int32_t i = p; i < last; ++i) {
    const Real* lower = stack.column[i + 1];
    const Real norm = square_root(upper[i] * upper[i] + stack.diagonal[i + 1] * stack.diagonal[i + 1]);
    const Real c = upper[i] / norm;
    const Real s = stack.diagonal[i + 1] / norm;
    stack.diagonal[i] = norm;
    for (std::int32_t j = i + 1; j < last; ++j) {
      stack.column[i][j - 1] = c * upper[j] + s * lower[j];
      upper[j] = c * lower[j] - s * upper[j];
    }
    const Real below = right[i + 1];
    right[i] = c * above + s * below;
    above = c * below - s * above;
  }
  stack.size = last;
}

/// Goes from x towards z (the free unknowns' values) as far as the bounds let it. Returns the unknown that met a bound
/// first and now rests on it, or -1.
inline std::int32_t advance(const BoxProblem& problem, const Box& box, std::uint32_t free_mask, const Real* z, Real* x) {
  Real part = 1;
  std::int32_t hit = -1;
  std::int32_t k = 0;
  for (std::int32_t j = 0; j < problem.columns; ++j) {
    if (!has(free_mask, j)) continue;
    const Real to = z[k++];
    if (!(to > box.high[j]) && !(to < box.low[j])) continue;
    const Real room = to > x[j] ? box.high[j] - x[j] : box.low[j] - x[j];
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
    const bool up = j == hit ? to > x[j] : next > box.high[j];
    const bool down = j == hit ? !up : next < box.low[j];
    x[j] = up ? box.high[j] : (down ? box.low[j] : next);
  }
  return hit;
}

inline bool inside(const BoxProblem& problem, const Box& box, const Real* x) {
  for (std::int32_t j = 0; j < problem.columns; ++j) {
    if (x[j] < box.low[j] || x[j] > box.high[j]) return false;
  }
  return true;
}

/// Where unknown j stands among the free ones.
inline std::int32_t place(std::uint32_t free_mask, std::int32_t j) {
  std::int32_t before = 0;
  for (std::int32_t i = 0; i < j; ++i) before += has(free_mask, i) ? 1 : 0;
  return before;
}

/// Solves the problem by an active set (Lawson, Hanson 1974, ch. 23; Stark, Parker 1995): each round either meets a
/// bound, which then holds, or lets go of the one that the residual pulls away from the hardest. The objective falls in
/// every round, so x is usable at the bound of rounds, or of the tick's work, too.
[[maybe_unused, gnu::noinline]] void solve(BoxProblem& problem, const Box& box, Real* x) {
  const std::int32_t equations = equations_of(problem);
  std::uint32_t movable = 0;
  for (std::int32_t j = 0; j < problem.columns; ++j) {
    x[j] = 0;
    if (box.high[j] > box.low[j]) movable |= 1U << static_cast<std::uint32_t>(j);
  }
  std::uint32_t free_mask = movable;
  Stack stack;
  Real right[max_joints];
  factor_free(problem, box.pull, free_mask, x, stack, right);
  for (std::int32_t round = 0; round < 3 * problem.columns && problem.budget > 0; ++round) {
    Real z[max_joints];
    solve_upper(stack, right, z);
    const std::int32_t hit = advance(problem, box, free_mask, z, x);
    if (hit >= 0) {
      hold(stack, right, place(free_mask, hit), x[hit]);
      --problem.budget;
      free_mask &= ~(1U << static_cast<std::uint32_t>(hit));
      continue;
    }
    if (free_mask == movable) break;
    Real* const left = z;  // which has served: the stack of a controller is short
    for (std::int32_t i = 0; i < equations; ++i) left[i] = problem.b[i];
    take_all(problem, x, left);
    Real hardest = 0;
    std::int32_t release = -1;
    for (std::int32_t j = 0; j < problem.columns; ++j) {
      if (!has(movable & ~free_mask, j)) continue;
      const Real slope =
          problem.damping * problem.damping * (box.pull[j] - x[j]) + product(problem.column[j], left, 6) +
          (equations > 6 ? problem.column[j][6] * left[6] : Real{0});
      const Real inward = x[j] < box.high[j] ? slope : -slope;
      if (inward > hardest) {
        hardest = inward;
        release = j;
      }
    }
    if (release < 0) break;
    free_mask |= 1U << static_cast<std::uint32_t>(release);
    factor_free(problem, box.pull, free_mask, x, stack, right);
  }
}

}  // namespace
}  // namespace mdhcal
