// SPDX-License-Identifier: MIT
#include "offline/assess/bootstrap.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "offline/base/random.hpp"
#include "offline/base/statistics.hpp"
#include "offline/identify/reduction.hpp"
#include "offline/identify/tikhonov.hpp"

namespace mdhcal::offline {

namespace {

// Joint functions and sag stay as they are found: what is drawn anew is the geometry.
Layout geometry_of(const Calibration& c) {
  Layout out = c.layout;
  out.terms.clear();
  return out;
}

// The weighted rows of one group, or their triangle where that is smaller.
struct GroupRows {
  std::vector<double> row;       // unknowns, then the residual, one after another
  std::size_t count = 0;
};

std::vector<GroupRows> rows_by_group(const Calibration& c, double noise_mm) {
  const Dataset& data = c.training;
  const bool any_sigma = states_sigma(data);
  const MeasurementModel model(c.estimate);
  const Layout layout = geometry_of(c);
  const std::size_t n = layout.columns();
  std::vector<std::int64_t> place(data.groups.size(), -1);
  std::vector<GroupRows> groups;
  std::vector<double> jacobian(max_row_residuals * n);
  for (std::size_t i = 0; i < c.training_rows.size(); ++i) {
    const std::size_t row = c.training_rows[i];
    const double weight = c.robust_weight.empty() ? 1.0 : std::sqrt(c.robust_weight[i]);
    if (!(weight > 0.0)) continue;
    std::int64_t& at = place[data.rows[row].group];
    if (at < 0) {
      at = static_cast<std::int64_t>(groups.size());
      groups.emplace_back();
    }
    GroupRows& group = groups[static_cast<std::size_t>(at)];
    double residual[max_row_residuals];
    double scale[max_row_residuals];
    const std::size_t count = model.residual(data, row, layout, residual, jacobian.data(), n);
    residual_scale(data, row, noise_mm, any_sigma, scale);
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t column = 0; column < n; ++column) {
        group.row.push_back(weight * scale[k] * jacobian[k * n + column]);
      }
      group.row.push_back(weight * scale[k] * residual[k]);
      ++group.count;
    }
  }
  for (GroupRows& group : groups) {
    if (group.count <= 2 * (n + 1)) continue;
    Triangle triangle(n);
    for (std::size_t k = 0; k < group.count; ++k) {
      const double* row = group.row.data() + k * (n + 1);
      triangle.add_row(row, row[n], 1.0);
    }
    const Eigen::MatrixXd& small = triangle.matrix();
    group.row.clear();
    for (Eigen::Index r = 0; r < small.rows(); ++r) {
      for (Eigen::Index column = 0; column < small.cols(); ++column) group.row.push_back(small(r, column));
    }
    group.count = n + 1;
  }
  return groups;
}

}  // namespace

Bootstrap bootstrap(const Calibration& c, std::size_t resamples, std::uint64_t seed, unsigned int threads,
                    const std::function<void(std::size_t, std::size_t)>& progress) {
  const double noise_mm = c.noise_mm;
  const std::vector<GroupRows> groups = rows_by_group(c, noise_mm);
  const Layout layout = geometry_of(c);
  const std::size_t n = layout.columns();
  const std::size_t parameters = layout.geometry.size();
  const std::vector<double> now = deviation(c.estimate, layout);
  const Eigen::VectorXd x0 = Eigen::Map<const Eigen::VectorXd>(now.data(), static_cast<Eigen::Index>(parameters));
  std::vector<std::vector<double>> drawn(parameters, std::vector<double>(resamples));

  std::atomic<std::size_t> done = 0;
  // Every resample has a seed of its own, so it does not matter which thread takes it.
  const auto work = [&](std::size_t first, std::size_t stride) {
    std::vector<std::size_t> times(groups.size());
    for (std::size_t r = first; r < resamples; r += stride) {
      Random random(seed * 0x9E3779B97F4A7C15ULL + r);
      std::fill(times.begin(), times.end(), std::size_t{0});
      for (std::size_t g = 0; g < groups.size(); ++g) ++times[random.index(groups.size())];
      Triangle triangle(n);
      for (std::size_t g = 0; g < groups.size(); ++g) {
        if (times[g] == 0) continue;
        const double weight = std::sqrt(static_cast<double>(times[g]));
        for (std::size_t k = 0; k < groups[g].count; ++k) {
          const double* row = groups[g].row.data() + k * (n + 1);
          triangle.add_row(row, row[n], weight);
        }
      }
      const ReducedSystem system = reduce_frames(triangle.matrix(), layout.frame_columns(), triangle.row_count());
      const Eigen::VectorXd x = penalised_problem(system, x0).solution(c.lambda.lambda);
      for (std::size_t p = 0; p < parameters; ++p) {
        drawn[p][r] = x(static_cast<Eigen::Index>(p)) * layout.geometry[p].prior;
      }
      if (progress) progress(++done, resamples);
    }
  };
  const std::size_t count = std::max<std::size_t>(1, threads > 0 ? threads : std::thread::hardware_concurrency());
  std::vector<std::thread> pool;
  for (std::size_t t = 1; t < count; ++t) pool.emplace_back(work, t, count);
  work(0, count);
  for (std::thread& thread : pool) thread.join();

  Bootstrap out;
  out.resamples = resamples;
  for (std::vector<double>& values : drawn) {
    std::sort(values.begin(), values.end());
    out.standard_deviation.push_back(statistics(values).sd);
    out.low.push_back(values.empty() ? 0.0 : percentile(values, 0.025));
    out.high.push_back(values.empty() ? 0.0 : percentile(values, 0.975));
  }
  return out;
}

}  // namespace mdhcal::offline
