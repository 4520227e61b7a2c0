// SPDX-License-Identifier: MIT
#include "tests/identify/ill_posed.hpp"

#include <Eigen/Eigenvalues>

#include <cmath>
#include <numbers>

namespace mdhcal::tests {

namespace {

constexpr double pi = std::numbers::pi;

IllPosed finished(std::string name, Eigen::MatrixXd a, Eigen::VectorXd x) {
  IllPosed out{std::move(name), std::move(a), std::move(x), {}};
  out.b = out.a * out.x;
  return out;
}

}  // namespace

IllPosed shaw(Eigen::Index n) {
  const double h = pi / static_cast<double>(n);
  const auto angle = [&](Eigen::Index i) { return -pi / 2 + (static_cast<double>(i) + 0.5) * h; };
  Eigen::MatrixXd a(n, n);
  Eigen::VectorXd x(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const double u = pi * (std::sin(angle(i)) + std::sin(angle(j)));
      const double sinc = std::fabs(u) < 1e-12 ? 1.0 : std::sin(u) / u;
      const double c = std::cos(angle(i)) + std::cos(angle(j));
      a(i, j) = h * c * c * sinc * sinc;
    }
    const double t = angle(i);
    x(i) = 2.0 * std::exp(-6.0 * (t - 0.8) * (t - 0.8)) + std::exp(-2.0 * (t + 0.5) * (t + 0.5));
  }
  return finished("shaw", a, x);
}

IllPosed phillips(Eigen::Index n) {
  const double h = 12.0 / static_cast<double>(n);
  const Eigen::Index quarter = n / 4;
  const auto c = [&](Eigen::Index k) { return std::cos(4.0 * pi * static_cast<double>(k) / static_cast<double>(n)); };
  Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
  for (Eigen::Index k = 0; k < quarter; ++k) {
    row(k) = h + 9.0 / (h * pi * pi) * (2.0 * c(k) - c(k - 1) - c(k + 1));
  }
  row(quarter) = h / 2 + 9.0 / (h * pi * pi) * (c(1) - 1.0);
  Eigen::MatrixXd a(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) a(i, j) = row(std::abs(i - j));
  }
  // The solution 1 + cos(pi t / 3) on |t| < 3, integrated over each cell and divided by the root of its width.
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  for (Eigen::Index k = 0; k < quarter; ++k) {
    const double from = h * static_cast<double>(k);
    const double part = (h + 3.0 / pi * (std::sin((from + h) * pi / 3.0) - std::sin(from * pi / 3.0))) / std::sqrt(h);
    x(2 * quarter + k) = part;
    x(2 * quarter - 1 - k) = part;
  }
  return finished("phillips", a, x);
}

IllPosed gravity(Eigen::Index n) {
  constexpr double depth = 0.25;
  const double h = 1.0 / static_cast<double>(n);
  Eigen::MatrixXd a(n, n);
  Eigen::VectorXd x(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const double apart = h * static_cast<double>(i - j);
      a(i, j) = h * depth * std::pow(depth * depth + apart * apart, -1.5);
    }
    const double t = (static_cast<double>(i) + 0.5) * h;
    x(i) = std::sin(pi * t) + 0.5 * std::sin(2.0 * pi * t);
  }
  return finished("gravity", a, x);
}

IllPosed i_laplace(Eigen::Index n) {
  Eigen::MatrixXd recurrence = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    recurrence(k, k) = 2.0 * static_cast<double>(k) + 1.0;
    if (k + 1 < n) recurrence(k, k + 1) = recurrence(k + 1, k) = static_cast<double>(k + 1);
  }
  const Eigen::VectorXd nodes = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(recurrence).eigenvalues();
  Eigen::MatrixXd a(n, n);
  Eigen::VectorXd x(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const double t = nodes(j);
    // Weight 1 / sum of the squared Laguerre polynomials below degree n: exact also where it is tiny.
    double before = 0.0;
    double here = 1.0;
    double squares = 1.0;
    for (Eigen::Index k = 0; k + 1 < n; ++k) {
      const auto degree = static_cast<double>(k);
      const double next = ((2.0 * degree + 1.0 - t) * here - degree * before) / (degree + 1.0);
      before = here;
      here = next;
      squares += here * here;
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      const double s = 10.0 / static_cast<double>(n) * static_cast<double>(i + 1);
      a(i, j) = std::exp((1.0 - s) * t - std::log(squares));
    }
    x(j) = std::exp(-0.5 * t);
  }
  return finished("i_laplace", a, x);
}

std::vector<IllPosed> ill_posed_problems(Eigen::Index n) {
  return {shaw(n), phillips(n), gravity(n), i_laplace(n)};
}

}  // namespace mdhcal::tests
