// SPDX-License-Identifier: MIT
#include "offline/identify/lambda_rules.hpp"

#include <algorithm>
#include <cmath>

namespace mdhcal::offline {

namespace {

constexpr int grid_points = 200;

std::vector<double> logarithmic(double low, double high, int points) {
  std::vector<double> out;
  for (int i = 0; i < points; ++i) {
    out.push_back(low * std::pow(high / low, static_cast<double>(i) / (points - 1)));
  }
  return out;
}

LambdaPoint point_at(const SpectralProblem& problem, double lambda, double criterion) {
  return {lambda, std::sqrt(problem.residual_norm2(lambda)), std::sqrt(problem.solution_norm2(lambda)), criterion};
}

template <class Function>
std::vector<LambdaPoint> sample(const SpectralProblem& problem, const Function& function, double widening = 1.0) {
  std::vector<LambdaPoint> curve;
  for (double lambda : logarithmic(widening * problem.smallest_lambda(), problem.largest_lambda(), grid_points)) {
    curve.push_back(point_at(problem, lambda, function(lambda)));
  }
  return curve;
}

// Minimum of a function of log(lambda) between two grid points, by golden section.
template <class Function>
double refine_minimum(double low, double high, const Function& function) {
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
  double a = std::log(low);
  double b = std::log(high);
  double x1 = b - ratio * (b - a);
  double x2 = a + ratio * (b - a);
  double f1 = function(std::exp(x1));
  double f2 = function(std::exp(x2));
  for (int i = 0; i < 40; ++i) {
    if (f1 <= f2) {
      b = x2, x2 = x1, f2 = f1;
      x1 = b - ratio * (b - a);
      f1 = function(std::exp(x1));
    } else {
      a = x1, x1 = x2, f1 = f2;
      x2 = a + ratio * (b - a);
      f2 = function(std::exp(x2));
    }
  }
  return std::exp(0.5 * (a + b));
}

template <class Function>
LambdaChoice global_minimum(const SpectralProblem& problem, const char* rule, const Function& function,
                            double widening = 1.0) {
  LambdaChoice choice;
  choice.rule = rule;
  if (problem.rank() == 0) return choice;
  choice.curve = sample(problem, function, widening);
  std::size_t best = 0;
  for (std::size_t i = 1; i < choice.curve.size(); ++i) {
    if (choice.curve[i].criterion < choice.curve[best].criterion) best = i;
  }
  const double low = choice.curve[best > 0 ? best - 1 : 0].lambda;
  const double high = choice.curve[std::min(best + 1, choice.curve.size() - 1)].lambda;
  choice.lambda = refine_minimum(low, high, function);
  choice.found = std::isfinite(choice.lambda);
  return choice;
}

std::size_t best_of(const std::vector<LambdaPoint>& curve) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    if (curve[i].criterion < curve[best].criterion) best = i;
  }
  return best;
}

void sort_by_lambda(std::vector<LambdaPoint>& curve) {
  std::sort(curve.begin(), curve.end(),
            [](const LambdaPoint& a, const LambdaPoint& b) { return a.lambda < b.lambda; });
}

}  // namespace

double l_curve_curvature(const SpectralProblem& problem, double lambda) {
  // Squared residual and solution norms and their derivatives with respect to t = log(lambda).
  double r = problem.outside2;
  double r1 = 0;
  double r2 = 0;
  double x = 0;
  double x1 = 0;
  double x2 = 0;
  for (Eigen::Index i = 0; i < problem.rank(); ++i) {
    const double s2 = problem.s(i) * problem.s(i);
    const double sum = s2 + lambda;
    const double b = problem.beta(i);
    const double share = lambda / sum;  // 1 - filter factor
    const double along = s2 * b * b / (sum * sum);
    r += share * share * b * b;
    r1 += 2.0 * share * lambda * along;
    r2 += lambda * along * (4.0 * share - 6.0 * share * share);
    x += along;
    x1 -= 2.0 * share * along;
    x2 -= 2.0 * share * along * (1.0 - 3.0 * share);
  }
  r1 = r1 > 0.0 ? r1 : 0.0;
  if (!(r > 0.0) || !(x > 0.0)) return 0.0;
  const double u1 = 0.5 * r1 / r;
  const double u2 = 0.5 * (r2 / r - (r1 / r) * (r1 / r));
  const double v1 = 0.5 * x1 / x;
  const double v2 = 0.5 * (x2 / x - (x1 / x) * (x1 / x));
  const double speed2 = u1 * u1 + v1 * v1;
  if (!(speed2 > 0.0)) return 0.0;
  return (u1 * v2 - u2 * v1) / (speed2 * std::sqrt(speed2));
}

LambdaChoice l_curve(const SpectralProblem& problem) {
  LambdaChoice choice;
  choice.rule = "l-curve";
  if (problem.rank() == 0) return choice;
  const auto curvature = [&](double lambda) { return l_curve_curvature(problem, lambda); };
  choice.curve = sample(problem, curvature);
  std::size_t best = 0;
  for (std::size_t i = 1; i + 1 < choice.curve.size(); ++i) {
    const double here = choice.curve[i].criterion;
    const bool corner = here > 0.0 && here >= choice.curve[i - 1].criterion && here >= choice.curve[i + 1].criterion;
    if (corner && (best == 0 || here > choice.curve[best].criterion)) best = i;
  }
  if (best == 0) {
    choice.note = "The L-curve has no convex corner within the bounds.";
    return choice;
  }
  choice.lambda = refine_minimum(choice.curve[best - 1].lambda, choice.curve[best + 1].lambda,
                                 [&](double lambda) { return -curvature(lambda); });
  choice.found = true;
  return choice;
}

LambdaChoice generalised_cross_validation(const SpectralProblem& problem) {
  return global_minimum(problem, "gcv", [&](double lambda) {
    const double freedom = static_cast<double>(problem.data_count) - problem.effective_parameters(lambda);
    return freedom > 0.0 ? problem.residual_norm2(lambda) / (freedom * freedom) : HUGE_VAL;
  });
}

double marginal_deviance(const SpectralProblem& problem, double lambda) {
  double squares = problem.outside2;
  double volume = 0.0;
  for (Eigen::Index i = 0; i < problem.rank(); ++i) {
    const double sum = problem.s(i) * problem.s(i) + lambda;
    squares += problem.beta(i) * problem.beta(i) * lambda / sum;
    volume += std::log(sum / lambda);
  }
  return static_cast<double>(problem.data_count) * std::log(squares) + volume;
}

LambdaChoice marginal_likelihood(const SpectralProblem& problem) {
  // Its criterion grows without bound as lambda falls, so it needs no lower bound against round-off, and where all
  // directions are well told the usual bound would already shrink the weakest by a tenth.
  constexpr double widening = 1e-8;
  return global_minimum(problem, "reml", [&](double lambda) { return marginal_deviance(problem, lambda); }, widening);
}

LambdaChoice quasi_optimality(const SpectralProblem& problem) {
  return global_minimum(problem, "quasi-optimality", [&](double lambda) {
    const auto sum = problem.s.array().square() + lambda;
    return std::sqrt((lambda * problem.s.array() * problem.beta.array() / sum.square()).square().sum());
  });
}

LambdaChoice discrepancy(const SpectralProblem& problem, double sigma) {
  LambdaChoice choice;
  choice.rule = "discrepancy";
  if (problem.rank() == 0) return choice;
  const double noise2 = sigma * sigma * static_cast<double>(problem.data_count);
  const auto excess = [&](double lambda) { return problem.residual_norm2(lambda) - noise2; };
  choice.curve = sample(problem, excess);
  if (choice.curve.front().criterion > 0.0) {
    choice.note = "The residual exceeds the stated noise for every lambda: the noise is understated or the model does "
                  "not hold all that moves.";
    return choice;
  }
  std::size_t crossing = choice.curve.size() - 1;
  while (crossing > 0 && choice.curve[crossing].criterion > 0.0) --crossing;
  if (crossing + 1 == choice.curve.size()) {
    choice.lambda = choice.curve.back().lambda;
    choice.found = true;
    return choice;
  }
  double low = std::log(choice.curve[crossing].lambda);
  double high = std::log(choice.curve[crossing + 1].lambda);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (excess(std::exp(middle)) > 0.0 ? high : low) = middle;
  }
  choice.lambda = std::exp(0.5 * (low + high));
  choice.found = true;
  return choice;
}

LambdaChoice cross_validation(const SpectralProblem& problem, const Judge& judge) {
  LambdaChoice choice;
  choice.rule = "cv";
  if (problem.rank() == 0) return choice;
  for (double lambda : logarithmic(problem.smallest_lambda(), problem.largest_lambda(), 40)) {
    choice.curve.push_back(point_at(problem, lambda, judge(lambda)));
  }
  const std::size_t best = best_of(choice.curve);
  const double low = choice.curve[best > 0 ? best - 1 : 0].lambda;
  const double high = choice.curve[std::min(best + 1, choice.curve.size() - 1)].lambda;
  for (double lambda : logarithmic(low, high, 10)) choice.curve.push_back(point_at(problem, lambda, judge(lambda)));
  sort_by_lambda(choice.curve);
  choice.lambda = choice.curve[best_of(choice.curve)].lambda;
  choice.found = true;
  return choice;
}

LambdaChoice two_stage_sweep(const SpectralProblem& problem, const Judge& judge, const std::string& rule) {
  LambdaChoice choice;
  choice.rule = rule;
  if (problem.rank() == 0) return choice;
  LambdaChoice start = l_curve(problem);
  if (!start.found) {
    choice.note = "The L-curve has no convex corner within the bounds: the sweep starts from the choice of generalised "
                  "cross-validation.";
    start = generalised_cross_validation(problem);
    if (!start.found) return choice;
  }
  const double floor = problem.smallest_lambda();
  const double ceiling = problem.largest_lambda();
  const double low = std::clamp(1e-9 * start.lambda, floor, ceiling);
  const double high = std::clamp(10.0 * start.lambda, floor, ceiling);
  for (double lambda : logarithmic(low, high, 30)) {
    choice.curve.push_back(point_at(problem, lambda, judge(lambda)));
  }
  const double best = choice.curve[best_of(choice.curve)].lambda;
  const double from = std::clamp(best / std::sqrt(10.0), floor, ceiling);
  const double to = std::clamp(best * std::sqrt(10.0), floor, ceiling);
  for (int i = 0; i < 10; ++i) {
    const double lambda = from + (to - from) * i / 9.0;
    choice.curve.push_back(point_at(problem, lambda, judge(lambda)));
  }
  sort_by_lambda(choice.curve);
  choice.lambda = choice.curve[best_of(choice.curve)].lambda;
  choice.found = true;
  return choice;
}

}  // namespace mdhcal::offline
