// SPDX-License-Identifier: MIT
#include "offline/identify/mistakes/judge.hpp"

#include <algorithm>
#include <cmath>

#include "offline/base/distributions.hpp"
#include "offline/base/error.hpp"
#include "offline/identify/mistakes/quick_fit.hpp"
#include "offline/identify/unknowns.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

constexpr double familywise_error = 1e-4;
constexpr double median_efficiency = 0.5;

}  // namespace

Job thinned(const Job& job, std::size_t most) {
  Job out{job.robot, job.data, job.options};
  const std::vector<Measurement>& rows = job.data.rows;
  const bool linked = std::any_of(rows.begin(), rows.end(),
                                  [](const Measurement& m) { return m.kind == MeasurementKind::distance; });
  if (rows.size() <= most || linked) return out;
  out.data.rows.clear();
  for (std::size_t k = 0; k < most; ++k) out.data.rows.push_back(rows[k * rows.size() / most]);
  out.data.commanded.clear();
  out.data.temperature.clear();
  out.data.direction.clear();
  return out;
}

namespace {

double smaller_spread_mm(const MeasurementModel& model, const Dataset& data) {
  std::vector<Vector3> measured;
  std::vector<Vector3> predicted;
  for (const Measurement& m : data.rows) {
    if (m.kind != MeasurementKind::position && m.kind != MeasurementKind::pose) continue;
    measured.push_back(m.position_m);
    predicted.push_back(model.target_position(m.q.data(), m.target));
  }
  return measured.empty() ? 1.0 : 1e3 * std::min(spread_of(measured), spread_of(predicted));
}

}  // namespace

double median_error_mm(const Estimate& estimate, const Dataset& data, std::size_t begin, std::size_t end) {
  const MeasurementModel model(estimate);
  std::vector<double> norms;
  for (std::size_t i = begin; i < end; ++i) {
    const Measurement& m = data.rows[i];
    norms.push_back(1e3 * norm(minus(model.target_position(m.q.data(), m.target), m.position_m)) / chi_median(3));
  }
  return robust_scale(norms, 1.0, 0.0);
}

Judgement judge(const Job& job) {
  Judgement out;
  const Job few = thinned(job, judging_rows);
  UnknownsOptions options;
  options.fit_base = job.options.fit_base;
  options.fit_tool = job.options.fit_tool;
  options.parameters = job.options.parameters;
  options.noise_mm = job.options.noise_mm.value_or(0.02);
  for (std::size_t row = 0; row < few.data.rows.size(); ++row) {
    if (few.data.rows[row].kind != MeasurementKind::joints) out.selection.rows.push_back(row);
  }
  try {
    const Unknowns unknowns = choose_unknowns(few.robot, few.data, out.selection.rows, options);
    out.layout = unknowns.layout;
    double scalars = 0.0;
    for (std::size_t row : out.selection.rows) scalars += static_cast<double>(residual_count(few.data.rows[row].kind));
    out.freedom = scalars - static_cast<double>(unknowns.layout.frame_columns());
    if (out.freedom < 1.0) return out;
    const bool any_sigma = states_sigma(few.data);
    const double unit_mm = any_sigma ? mean_sigma_mm(few.data, out.selection.rows, options.noise_mm) : 1.0;
    const double noise = any_sigma ? 1.0 : options.noise_mm;
    const Fit frames = fit_frames(unknowns, few.data, out.selection, options.noise_mm);
    FitControl control;
    control.loss = Loss::huber;
    control.noise_mm = options.noise_mm;
    control.lambda = noise * noise;
    control.max_iterations = 15;
    control.tolerance = 1e-2;
    out.fit = fit(few.data, out.selection, unknowns.layout, frames.estimate, control);
    out.spread_mm = smaller_spread_mm(MeasurementModel(out.fit.estimate), few.data);
    double norm2 = 0.0;
    for (double x : deviation(out.fit.estimate, unknowns.layout)) norm2 += x * x;
    // The residual's scale without the geometry's share of freedom: that is what the deviations are counted for.
    const double scale = robust_scale(out.fit.error_norms, std::sqrt(scalars / out.freedom), noise);
    out.residual_mm = unit_mm * scale;
    out.scale_mm = unit_mm * std::sqrt(scale * scale + noise * noise * norm2 / out.freedom);
  } catch (const std::runtime_error&) {
    out.scale_mm = HUGE_VAL;  // out of range, or not to be told from these rows: no cure
  }
  return out;
}

bool explains_more(double a_mm, double b_mm, double freedom_a, double freedom_b, std::size_t trials) {
  if (!(b_mm < a_mm)) return false;
  constexpr double least_mm = 1e-9;  // an exact fit has no ratio
  const double ratio = a_mm / std::max(b_mm, least_mm);
  const double half_a = median_efficiency * freedom_a;
  const double half_b = median_efficiency * freedom_b;
  return half_a >= 1.0 && half_b >= 1.0 &&
         f_upper_tail(ratio * ratio, half_a, half_b) * static_cast<double>(trials) < familywise_error;
}

}  // namespace mdhcal::offline
