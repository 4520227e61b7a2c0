// SPDX-License-Identifier: MIT
#include "offline/identify/mistakes/series.hpp"

#include <algorithm>
#include <cmath>

#include "offline/base/error.hpp"
#include "offline/base/sentences.hpp"
#include "offline/identify/mistakes/quick_fit.hpp"
#include "offline/identify/registration.hpp"
#include "offline/robot/units.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

// Four points off a line tell a frame with freedom left over: twelve coordinates for six unknowns.
constexpr std::size_t least_stands = 4;
constexpr std::size_t most_splits = 60;
constexpr std::size_t most_placing_rows = 400;  // tell the place; the judgement that follows is of its own rows
constexpr int most_rounds = 5;

bool states_position(const Measurement& m) {
  return m.kind == MeasurementKind::position || m.kind == MeasurementKind::pose;
}

// Rows at which the arm stands anew, in file order: where a series may be cut.
std::vector<std::size_t> stands(const Dataset& data) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    if (!states_position(data.rows[i])) continue;
    if (out.empty() || data.rows[i].q != data.rows[i - 1].q) out.push_back(i);
  }
  return out;
}

struct Registered {
  Frame<double> frame{};
  double sum_m = 0;  // of the error norms
};

// The rigid fit of least summed error norms: a gross row weighs no more than its length.
Registered registered(const std::vector<Vector3>& a, const std::vector<Vector3>& b, std::size_t begin, std::size_t end) {
  const auto part = [&](const std::vector<Vector3>& v) {
    return std::vector<Vector3>(v.begin() + static_cast<std::ptrdiff_t>(begin), v.begin() + static_cast<std::ptrdiff_t>(end));
  };
  const std::vector<Vector3> from = part(a);
  const std::vector<Vector3> to = part(b);
  Registered out;
  std::vector<double> weight;
  for (int k = 0; k < 4; ++k) {
    out.frame = rigid_fit(from, to, weight);
    out.sum_m = 0.0;
    weight.assign(from.size(), 1.0);
    for (std::size_t i = 0; i < from.size(); ++i) {
      const double e = norm(minus(transform(out.frame, from[i]), to[i]));
      out.sum_m += e;
      weight[i] = 1.0 / std::max(e, 1e-6);  // a micrometre: below it there is nothing left to weigh
    }
  }
  return out;
}

struct Move {
  std::size_t row = 0;          // the first one after it
  Frame<double> back{};         // from the later frame to the earlier one
  double sum_m = HUGE_VAL;
};

// Of all places the one where two registrations leave least.
Move best_place(const Dataset& data, const Estimate& estimate) {
  const MeasurementModel model(estimate);
  std::vector<std::size_t> rows;
  std::vector<Vector3> predicted;
  std::vector<Vector3> measured;
  const std::size_t every = (data.rows.size() + most_placing_rows - 1) / most_placing_rows;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const Measurement& m = data.rows[i];
    if (!states_position(m) || i % every != 0) continue;
    rows.push_back(i);
    predicted.push_back(model.target_position(m.q.data(), m.target));
    measured.push_back(m.position_m);
  }
  const std::vector<std::size_t> places = stands(data);
  Move out;
  if (places.size() < 2 * least_stands) return out;
  const std::size_t candidates = places.size() - 2 * least_stands + 1;
  const std::size_t stride = (candidates + most_splits - 1) / most_splits;
  const auto try_place = [&](std::size_t k) {
    const std::size_t row = places[k];
    const auto at = static_cast<std::size_t>(std::lower_bound(rows.begin(), rows.end(), row) - rows.begin());
    if (at < least_stands || rows.size() - at < least_stands) return false;
    const Registered before = registered(predicted, measured, 0, at);
    const Registered after = registered(predicted, measured, at, rows.size());
    if (before.sum_m + after.sum_m < out.sum_m) {
      out.row = row;
      out.back = compose(before.frame, inverted(after.frame));
      out.sum_m = before.sum_m + after.sum_m;
      return true;
    }
    return false;
  };
  std::size_t best = least_stands;
  for (std::size_t k = least_stands; k <= places.size() - least_stands; k += stride) {
    if (try_place(k)) best = k;
  }
  if (stride > 1) {  // between the places tried
    const std::size_t low = best > least_stands + stride ? best - stride : least_stands;
    const std::size_t high = std::min(best + stride, places.size() - least_stands);
    for (std::size_t k = low; k <= high; ++k) (void)try_place(k);
  }
  return out;
}

void move_back(Dataset& data, std::size_t from, const Frame<double>& back) {
  for (std::size_t i = from; i < data.rows.size(); ++i) {
    Measurement& m = data.rows[i];
    if (!states_position(m)) continue;
    m.position_m = transform(back, m.position_m);
    if (m.kind != MeasurementKind::pose) continue;
    const Pose<double> turned = pose_of(compose(back, frame_of(m.quaternion, Vector3{})));
    for (std::size_t k = 0; k < 4; ++k) m.quaternion[k] = turned.quaternion[k];
  }
}

Job part_of(const Job& job, std::size_t begin, std::size_t end) {
  Job out{job.robot, job.data, job.options};
  out.data.rows.assign(job.data.rows.begin() + static_cast<std::ptrdiff_t>(begin),
                       job.data.rows.begin() + static_cast<std::ptrdiff_t>(end));
  out.data.commanded.clear();
  out.data.temperature.clear();
  out.data.direction.clear();
  return out;
}

Hypothesis moved(const Job& job, const Move& move) {
  Hypothesis h;
  h.kind = MistakeKind::moved;
  h.rows = true;
  const Measurement& row = job.data.rows[move.row];
  const double shift_mm = mm_per_m * norm(minus(transform(move.back, row.position_m), row.position_m));
  const double turn_deg = deg_per_rad * norm(log_of_rotation(move.back));
  h.what = "the tracker, or the robot's foot, moved before row " + row_name(job.data, row) + " (line " +
           std::to_string(row.line) + ") by " + number(shift_mm) + " mm and " + number(turn_deg, 3) + " degrees";
  h.cure = "calibrate from one series, or bring the rows from there on into the frame of those before";
  const std::size_t from = h.place = move.row;
  const Frame<double> back = move.back;
  h.apply = [from, back](Job& j) {
    move_back(j.data, from, back);
    return true;
  };
  return h;
}

}  // namespace

std::vector<Hypothesis> moved_tracker(const Job& job, const Judgement& at) {
  const std::size_t rows = job.data.rows.size();
  if (std::any_of(job.data.rows.begin(), job.data.rows.end(), [](const Measurement& m) { return !states_position(m); }) ||
      stands(job.data).size() < 2 * least_stands) {
    return {};
  }
  std::vector<Estimate> starts;
  if (at.scale_mm < HUGE_VAL) starts.push_back(at.fit.estimate);
  for (const Job& half : {part_of(job, 0, rows / 2), part_of(job, rows / 2, rows)}) {
    const Judgement one = judge(half);
    if (one.scale_mm < HUGE_VAL) starts.push_back(one.fit.estimate);
  }
  Move best;
  double best_mm = HUGE_VAL;
  for (Estimate estimate : starts) {
    double last_mm = HUGE_VAL;
    for (int round = 0; round < most_rounds; ++round) {
      Move move;
      try {
        move = best_place(job.data, estimate);
      } catch (const std::runtime_error&) {
        break;  // a geometry or reading out of range
      }
      if (!(move.sum_m < HUGE_VAL)) break;
      Job joined = job;
      move_back(joined.data, move.row, move.back);
      const Judgement now = judge(joined);
      if (now.scale_mm < best_mm) {
        best_mm = now.scale_mm;
        best = move;
      }
      if (!(now.scale_mm < 0.98 * last_mm)) break;
      last_mm = now.scale_mm;
      estimate = now.fit.estimate;
    }
  }
  if (!(best_mm < HUGE_VAL)) return {};
  return {moved(job, best)};
}

std::vector<Hypothesis> slipped_rows(const Job& job) {
  std::vector<Hypothesis> out;
  const std::vector<std::size_t> places = stands(job.data);
  if (places.size() < 2 * least_stands) return out;
  Estimate nominal;
  nominal.geometry = job.robot.geometry;
  nominal.flange_p_m.assign(std::max<std::size_t>(1, job.data.targets.size()), job.robot.tool_p_m.value_or(Vector3{}));
  // The mean error, not the median: rows out of step on the wrong side of the place have to count.
  const auto mean_error_m = [&](const Hypothesis& h) {
    Job changed = job;
    if (!h.apply(changed)) return HUGE_VAL;
    const std::vector<Sighting> sightings = sightings_of(thinned(changed, judging_rows).data);
    const QuickFit fit = quick_fit(nominal, sightings);
    if (!(fit.misfit < HUGE_VAL)) return HUGE_VAL;
    const MeasurementModel model(fit.estimate);
    double sum = 0.0;
    for (const Sighting& s : sightings) sum += norm(minus(model.target_position(s.q.data(), s.target), s.measured_m));
    return sum / static_cast<double>(sightings.size());
  };
  const std::size_t stride = (places.size() + most_splits - 1) / most_splits;
  for (const int shift : {1, -1}) {
    double best_m = HUGE_VAL;
    std::size_t best = 0;
    const auto try_place = [&](std::size_t k) {
      const double now_m = mean_error_m(shifted_rows(job, shift, places[k]));
      if (now_m < best_m) {
        best_m = now_m;
        best = k;
      }
    };
    for (std::size_t k = 1; k + 1 < places.size(); k += stride) try_place(k);
    for (std::size_t step = stride / 2; step > 0 && best > 0; step /= 2) {
      const std::size_t middle = best;
      if (middle > step) try_place(middle - step);
      if (middle + step + 1 < places.size()) try_place(middle + step);
    }
    if (best > 0) {
      out.push_back(shifted_rows(job, shift, places[best]));
      out.back().place = places[best];
    }
  }
  return out;
}

std::vector<Hypothesis> repeated_points(const Job& job) {
  // Readings that differ by less than this could be one stand of the arm.
  constexpr double moved_rad = 0.5 * rad_per_deg;
  std::vector<std::size_t> later;
  const std::vector<Measurement>& rows = job.data.rows;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (!states_position(rows[i]) || !states_position(rows[i - 1]) || rows[i].target != rows[i - 1].target) continue;
    if (norm(minus(rows[i].position_m, rows[i - 1].position_m)) > 0.0) continue;
    double turned = 0.0;
    for (std::size_t j = 0; j < job.data.joint_count; ++j) turned = std::max(turned, std::fabs(rows[i].q[j] - rows[i - 1].q[j]));
    if (turned > moved_rad) later.push_back(i);
  }
  std::vector<Hypothesis> out;
  if (later.empty()) return out;
  for (const std::size_t back : {0U, 1U}) {
    Hypothesis h;
    h.kind = MistakeKind::repeated;
    h.rows = true;
    std::vector<std::string> names;
    for (std::size_t k = 0; k < later.size() && k < 5; ++k) names.push_back(row_name(job.data, rows[later[k] - back]));
    if (later.size() > 5) names.push_back("...");
    h.what = "the points of rows that repeat their neighbour's left out (row " + joined(names) + ")";
    h.cure = "leave out row " + joined(names) + ": the same point stands beside two different sets of joints";
    h.apply = [later, back](Job& j) {
      if (j.data.rows.size() <= later.back()) return false;
      for (std::size_t k = later.size(); k-- > 0;) {
        j.data.rows.erase(j.data.rows.begin() + static_cast<std::ptrdiff_t>(later[k] - back));
      }
      j.data.commanded.clear();
      j.data.temperature.clear();
      j.data.direction.clear();
      return true;
    };
    out.push_back(h);
  }
  return out;
}

}  // namespace mdhcal::offline
