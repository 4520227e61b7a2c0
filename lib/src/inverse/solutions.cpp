// SPDX-License-Identifier: MIT
#include "mdhcal/solutions.hpp"

#include "arm/chain.hpp"
#include "inverse/closed_form.hpp"
#include "inverse/levenberg.hpp"
#include "inverse/regular_tick.hpp"
#include "number/real.hpp"
#include "inverse/goal_valid.hpp"

namespace mdhcal {

namespace {

constexpr Real full_turn = Real(6.28318530717958647692);
/// Solutions nearer than this, modulo full turns, are one.
constexpr Real same_solution = sizeof(Real) == sizeof(double) ? Real(1e-3) : Real(5e-3);

struct Search {
  const Real* posture;
  Pose<Real> target;
  Goal goal;
  TickOptions<Real> tick;       ///< the same goal, no step limits
  std::uint32_t periodic_mask;  ///< joints for which a full turn of the reading changes nothing
  mutable Real smallest;        ///< singular value near any solution found so far, a bound from below; at first 1
};

bool bit(std::uint32_t mask, std::int32_t j) { return ((mask >> static_cast<std::uint32_t>(j)) & 1U) != 0U; }

Real whole(Real x) {
  return static_cast<Real>(static_cast<std::int32_t>(x < Real{0} ? x - Real(0.5) : x + Real(0.5)));
}

std::uint32_t periodic_joints(const Arm<Real>& arm) {
  std::uint32_t mask = 0;
  for (std::int32_t j = 0; j < arm.joint_count; ++j) {
    bool periodic = !bit(arm.prismatic_mask, j);
    for (std::int32_t i = 0; i < arm.joint_count; ++i) {
      const Real ratio = arm.map[i][j];
      const bool moves_slide = bit(arm.prismatic_mask, i) && magnitude(ratio) > Real{0};
      if (moves_slide || magnitude(ratio - whole(ratio)) > Real{0}) periodic = false;
    }
    if (periodic) mask |= 1U << static_cast<std::uint32_t>(j);
  }
  return mask;
}

// The least integer that is not below x.
Real up(Real x) {
  const Real nearest_whole = whole(x);
  return nearest_whole < x ? nearest_whole + Real{1} : nearest_whole;
}

// Moves q, reading j, by the fewest full turns from the one nearest to the posture to an allowed one, which may be beyond
// a limit by `slack` and is then put on it. Returns whether there is one.
bool choose_turn(const Search& search, std::int32_t j, Real slack, Real& q) {
  const Arm<Real>& arm = *search.goal.arm;
  const Real min = bit(arm.min_mask, j) ? arm.min[j] : -static_cast<Real>(max_reading);
  const Real max = bit(arm.max_mask, j) ? arm.max[j] : static_cast<Real>(max_reading);
  Real turned = q;
  if (bit(search.periodic_mask, j)) {
    turned -= full_turn * whole((turned - search.posture[j]) / full_turn);
    if (turned < min - slack) turned += full_turn * up((min - slack - turned) / full_turn);
    if (turned > max + slack) turned -= full_turn * up((turned - max - slack) / full_turn);
  }
  if (turned < min - slack || turned > max + slack) return false;
  q = turned < min ? min : (turned > max ? max : turned);
  return true;
}

// How a value found fits the joint limits: as it is, but for turns or a limit that it was moved by or put on, or not.
enum class Fit : std::int32_t { as_it_is, moved, outside };

// Beyond a limit by no more than the tolerance is on it; else by no more than what tells two solutions apart, if no full turn
// is allowed.
Fit fit_limits(const Search& search, Real* q) {
  const GoalOptions<Real>& goal = *search.goal.options;
  const Real tolerance = goal.rotation_tolerance_rad < same_solution ? goal.rotation_tolerance_rad : same_solution;
  Fit fit = Fit::as_it_is;
  for (std::int32_t j = 0; j < search.goal.arm->joint_count; ++j) {
    const Real unit = joint_unit(search.goal, j);
    const Real before = q[j];
    if (!choose_turn(search, j, tolerance * unit, q[j]) && !choose_turn(search, j, same_solution * unit, q[j])) {
      return Fit::outside;
    }
    if (magnitude(q[j] - before) > Real{0}) fit = Fit::moved;
  }
  return fit;
}

Real joint_distance(const Search& search, const Real* a, const Real* b, bool modulo) {
  Real largest = 0;
  for (std::int32_t j = 0; j < search.goal.arm->joint_count; ++j) {
    Real difference = a[j] - b[j];
    if (modulo && bit(search.periodic_mask, j)) difference -= full_turn * whole(difference / full_turn);
    difference /= joint_unit(search.goal, j);
    if (magnitude(difference) > largest) largest = magnitude(difference);
  }
  return largest;
}

bool meets(const Search& search, const Real* q) {
  Frame<Real> frame;
  PoseError error;
  bool met = false;
  evaluate(*search.goal.arm, q, frame);
  squared_error(search.goal, frame, error, met);
  return met;
}

// From a starting value to joints that meet the pose: the regular tick where the value is near enough for it.
bool arrive(const Search& search, Real* q) {
  const std::int32_t joints = search.goal.arm->joint_count;
  if (joints == 6 && search.goal.options->task == Task::pose) {
    TickState state;
    static_cast<Goal&>(state) = search.goal;
    state.tick = &search.tick;
    state.evaluations = 0;
    for (std::int32_t j = 0; j < joints; ++j) {
      state.q[j] = q[j];
      state.low[j] = -static_cast<Real>(max_reading);
      state.high[j] = static_cast<Real>(max_reading);
    }
    Look look;
    if (regular_tick(state, look)) {
      for (std::int32_t j = 0; j < joints; ++j) q[j] = state.q[j];
      if (state.smallest_singular_value < search.smallest) search.smallest = state.smallest_singular_value;
      return true;
    }
  }
  if (!refine(search.goal, q)) return false;
  search.smallest = 0;  // the value was far, or the arm is near a singularity
  return true;
}

// Joints that met the pose, within the limits now; those of them that were moved are looked at again, since turns are added in
// rounded numbers and a limit takes the rest of a joint's motion away: the others then make up for it.
bool settle(const Search& search, Real* q) {
  const Fit fit = fit_limits(search, q);
  if (fit != Fit::moved) return fit == Fit::as_it_is;
  if (!readings_valid(*search.goal.arm, q)) return false;
  return meets(search, q) || tick(*search.goal.arm, search.tick, search.target, q) == Status::ok;
}

// Goes on from a starting value and adds what it leads to, if that is new; a full list keeps the nearest. The list is
// sorted at all times.
void consider(const Search& search, Real* q, Solutions<Real>& found) {
  const std::int32_t joints = search.goal.arm->joint_count;
  if (!arrive(search, q) || !settle(search, q)) return;
  for (std::int32_t k = 0; k < found.count; ++k) {
    if (joint_distance(search, q, found.q[k], true) < same_solution) return;
  }
  const Real distance = joint_distance(search, q, search.posture, false);
  if (found.count == max_solutions) {
    if (!(distance < found.distance[max_solutions - 1])) return;
    --found.count;
  }
  std::int32_t place = found.count++;
  for (; place > 0 && distance < found.distance[place - 1]; --place) {
    for (std::int32_t j = 0; j < joints; ++j) found.q[place][j] = found.q[place - 1][j];
    found.distance[place] = found.distance[place - 1];
  }
  for (std::int32_t j = 0; j < joints; ++j) found.q[place][j] = q[j];
  found.distance[place] = distance;
}

// Readings from joint coordinates: the couplings' linear system by Gaussian elimination with row exchanges. Returns
// false if the couplings have no unique answer.
bool readings_of(const Arm<Real>& arm, const Real* coordinates, Real* q) {
  const std::int32_t joints = arm.joint_count;
  Real a[max_joints][max_joints + 1];
  for (std::int32_t i = 0; i < joints; ++i) {
    for (std::int32_t j = 0; j < joints; ++j) a[i][j] = arm.map[i][j];
    a[i][joints] = coordinates[i];
  }
  for (std::int32_t k = 0; k < joints; ++k) {
    std::int32_t pivot = k;
    for (std::int32_t i = k + 1; i < joints; ++i) {
      if (magnitude(a[i][k]) > magnitude(a[pivot][k])) pivot = i;
    }
    if (!(magnitude(a[pivot][k]) > Real(1e-6))) return false;
    for (std::int32_t j = k; j <= joints; ++j) {
      const Real swap = a[k][j];
      a[k][j] = a[pivot][j];
      a[pivot][j] = swap;
    }
    for (std::int32_t i = k + 1; i < joints; ++i) {
      const Real factor = a[i][k] / a[k][k];
      for (std::int32_t j = k; j <= joints; ++j) a[i][j] -= factor * a[k][j];
    }
  }
  for (std::int32_t i = joints - 1; i >= 0; --i) {
    Real sum = a[i][joints];
    for (std::int32_t j = i + 1; j < joints; ++j) sum -= a[i][j] * q[j];
    q[i] = sum / a[i][i];
    if (!(magnitude(q[i]) <= static_cast<Real>(max_reading))) return false;
  }
  return true;
}

// Roots that coincide within this are also tried apart [rad].
constexpr Real nearly_double = Real(0.35);
// A singular value below this, a bound that is at most sqrt(6) below it, is that of an arm within 0.01 of a singularity: a
// solution may be one of several close together.
constexpr Real nearly_singular = Real(0.004);
// A wrist that the closed form has straighter than this is near its singularity whatever was found: the angle that errors of
// 5 mm and half a degree come to twice over [rad].
constexpr Real nearly_straight = Real(0.03);
// With a nearly straight wrist joint 6 may be anywhere as long as the joints before it make up for it, and with the wrist
// nearly on axis 1, within this part of the reach, joint 1 may: where the pose is met depends on the arm's errors, so it
// is tried all around. Solutions lie in pairs close together there; so many values find nine of ten poses complete.
constexpr int wrist_turns = 32;
constexpr int base_turns = 64;
constexpr Real near_axis = Real(0.05);

void consider_coordinates(const Search& search, const Real* coordinates, Solutions<Real>& found) {
  Real q[max_joints] = {};
  if (readings_of(*search.goal.arm, coordinates, q)) consider(search, q, found);
}

void try_departure(const Search& search, const Screws& screws, const Departure& departure, StartingValues& values,
                   Solutions<Real>& found) {
  closed_form(screws, search.goal.target, departure, values);
  for (std::int32_t k = 0; k < values.count; ++k) consider_coordinates(search, values.coordinates[k], found);
}

// Whether there may be solutions that the closed form's plain values do not lead to.
bool may_be_more(const Search& search, const Solutions<Real>& found) {
  return found.count == 0 || search.smallest < nearly_singular;
}

// The closed form's values; on both sides of folds; all around where a joint may be anywhere, with `first_only` only if
// nothing was found before.
void try_closed_form(const Search& search, const Screws& screws, bool first_only, Solutions<Real>& found) {
  StartingValues values;
  try_departure(search, screws, {Real{0}, Real{0}, Real{0}}, values, found);
  const bool singular = may_be_more(search, found);
  const bool straight = values.wrist_smallest < (singular ? nearly_double : nearly_straight);
  const bool above = singular && values.base_radius_m < near_axis * search.goal.arm->reach_m;
  if (values.wrist_smallest < nearly_double || values.smallest < nearly_double) {
    try_departure(search, screws, {Real(0.1), Real{0}, Real{0}}, values, found);
    try_departure(search, screws, {Real(0.3), Real{0}, Real{0}}, values, found);
  }
  if (first_only && found.count > 0) return;
  for (int n = 1; straight && n < wrist_turns; ++n) {
    const Real angle = full_turn / static_cast<Real>(wrist_turns) * static_cast<Real>(n);
    try_departure(search, screws, {Real(0.01), Real{0}, angle}, values, found);
  }
  for (int n = 1; above && n < base_turns; ++n) {
    const Real angle = full_turn / static_cast<Real>(base_turns) * static_cast<Real>(n);
    try_departure(search, screws, {n % 2 == 0 ? Real(0.05) : Real(0.3), angle, Real{0}}, values, found);
  }
}

// Fixed pseudo-random joints (Marsaglia 2003, xorshift), within the limits or half a turn or the reach about the posture.
void restart_joints(const Search& search, std::uint32_t& state, Real* q) {
  const Arm<Real>& arm = *search.goal.arm;
  for (std::int32_t j = 0; j < arm.joint_count; ++j) {
    state ^= state << 13U;
    state ^= state >> 17U;
    state ^= state << 5U;
    const Real unit = static_cast<Real>(state >> 8U) * Real(1.0F / 16777216.0F);
    const Real width = bit(arm.prismatic_mask, j) ? arm.reach_m : Real(0.5) * full_turn;
    Real low = search.posture[j] - width;
    Real high = search.posture[j] + width;
    if (bit(arm.min_mask, j) && low < arm.min[j]) low = arm.min[j];
    if (bit(arm.max_mask, j) && high > arm.max[j]) high = arm.max[j];
    q[j] = low + unit * (high - low);
    if (!(magnitude(q[j]) <= static_cast<Real>(max_reading))) q[j] = search.posture[j];
  }
}

void try_restarts(const Search& search, std::int32_t restarts, bool first_only, Solutions<Real>& found) {
  std::uint32_t state = 0x9E3779B9U;
  for (std::int32_t n = 0; n < restarts && !(first_only && found.count > 0); ++n) {
    Real q[max_joints];
    restart_joints(search, state, q);
    consider(search, q, found);
  }
}

void search_all(const Search& search, std::int32_t restarts, bool first_only, Solutions<Real>& found) {
  Screws screws;
  read_screws(*search.goal.arm, screws);
  found.count = 0;
  found.family = screws.family;
  const bool closed = screws.family != ArmFamily::general && search.goal.options->task == Task::pose;
  if (closed) try_closed_form(search, screws, first_only, found);
  // Where the closed form has found what there is, the posture leads to nothing new.
  if (!closed || may_be_more(search, found)) {
    Real q[max_joints];
    for (std::int32_t j = 0; j < search.goal.arm->joint_count; ++j) q[j] = search.posture[j];
    consider(search, q, found);
  }
  try_restarts(search, restarts, first_only, found);
}

bool prepare(const Arm<Real>& arm, const SolutionOptions<Real>& options, const Pose<Real>& target, const Real* posture,
             Search& search) {
  if (!readings_valid(arm, posture) || !goal_valid(options.goal) || !target_valid(target)) return false;
  if (options.restarts < 0 || options.restarts > max_restarts) return false;
  search.posture = posture;
  search.periodic_mask = periodic_joints(arm);
  search.goal.arm = &arm;
  search.goal.options = &options.goal;
  // Starting values are refined from far off, where the whole reach is the scale of an error.
  search.goal.length_m = arm.reach_m > Real(1e-6) ? arm.reach_m : Real{1};
  search.target = target;
  search.smallest = 1;
  search.tick = default_tick_options(arm);
  search.tick.goal = options.goal;
  to_frame(target, search.goal.target);
  return true;
}

}  // namespace

ArmFamily family_of(const Arm<Real>& arm) noexcept {
  Screws screws;
  read_screws(arm, screws);
  return screws.family;
}

SolutionOptions<Real> default_solution_options(const Arm<Real>& arm) noexcept {
  SolutionOptions<Real> options{};
  options.goal = default_tick_options(arm).goal;
  options.restarts = family_of(arm) == ArmFamily::general ? 100 : 0;
  return options;
}

Status find_solutions(const Arm<Real>& arm, const SolutionOptions<Real>& options, const Pose<Real>& base_T_flange,
                      const Real* posture, Solutions<Real>& solutions) noexcept {
  Search search;
  if (!prepare(arm, options, base_T_flange, posture, search)) return Status::bad_input;
  search_all(search, options.restarts, false, solutions);
  return solutions.count > 0 ? Status::ok : Status::out_of_reach;
}

Status cold_start(const Arm<Real>& arm, const SolutionOptions<Real>& options, const Pose<Real>& base_T_flange,
                  Real* q) noexcept {
  Search search;
  if (!prepare(arm, options, base_T_flange, q, search)) return Status::bad_input;
  Solutions<Real> found;
  search_all(search, options.restarts, true, found);
  if (found.count == 0) return Status::out_of_reach;
  for (std::int32_t j = 0; j < arm.joint_count; ++j) q[j] = found.q[0][j];
  return Status::ok;
}

}  // namespace mdhcal
