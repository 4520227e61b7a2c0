// SPDX-License-Identifier: MIT
// Condition number and observability indices by another road: differences, an explicit projector, eigenvalues and a
// determinant of the normal matrix.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <cmath>

#include "offline/simulate/family.hpp"
#include "tests/identify/simulated.hpp"

namespace {

using namespace mdhcal::offline;
using namespace mdhcal::tests;

// d(residual)/d(unknowns) of all rows by central differences [mm per unit].
Eigen::MatrixXd differences(const Calibration& c, const Estimate& at) {
  const auto n = static_cast<Eigen::Index>(c.layout.columns());
  Eigen::MatrixXd jacobian(static_cast<Eigen::Index>(3 * c.training.rows.size()), n);
  constexpr double h = 0.5;
  for (Eigen::Index column = 0; column < n; ++column) {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(n);
    step(column) = h;
    const MeasurementModel up(moved(at, c.layout, step.data()));
    step(column) = -h;
    const MeasurementModel down(moved(at, c.layout, step.data()));
    for (std::size_t row = 0; row < c.training.rows.size(); ++row) {
      double a[max_row_residuals];
      double b[max_row_residuals];
      up.residual(c.training, row, a);
      down.residual(c.training, row, b);
      for (std::size_t k = 0; k < 3; ++k) {
        jacobian(static_cast<Eigen::Index>(3 * row + k), column) = (a[k] - b[k]) / (2 * h);
      }
    }
  }
  return jacobian;
}

void expect_spectrum(const Spectrum& said, const Eigen::MatrixXd& jacobian, Eigen::Index frames) {
  const Eigen::MatrixXd f = jacobian.leftCols(frames);
  const Eigen::MatrixXd inverse = (f.transpose() * f).inverse();
  const Eigen::MatrixXd g = jacobian.rightCols(jacobian.cols() - frames);
  const Eigen::MatrixXd a = g - f * (inverse * (f.transpose() * g));
  const Eigen::VectorXd norms = a.colwise().norm().transpose();
  const Eigen::MatrixXd scaled = norms.mean() * a * norms.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd normal = scaled.transpose() * scaled;
  const Eigen::VectorXd s = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(normal).eigenvalues().cwiseSqrt();
  const double least = s(0);
  const double most = s(s.size() - 1);
  const auto r = static_cast<double>(s.size());
  ASSERT_EQ(said.rank, static_cast<std::size_t>(s.size()));
  const auto near = [](double value, double truth, const char* what) {
    EXPECT_NEAR(value, truth, 1e-4 * truth) << what;
  };
  near(said.condition, most / least, "condition number");
  near(said.observability[0], std::pow(normal.determinant(), 0.5 / r) / std::sqrt(static_cast<double>(a.rows())), "O1");
  near(said.observability[1], least / most, "O2");
  near(said.observability[2], least, "O3");
  near(said.observability[3], least * least / most, "O4");
  near(said.observability[4], 1.0 / s.cwiseInverse().sum(), "O5");
}

TEST(Spectrum, ConditionAndObservabilityBeforeAndAfter) {
  for (const std::string& family : family_names()) {
    SCOPED_TRACE(family);
    const Simulation s = simulate(family_robot(family), arm_options(2));
    CalibrationOptions options;
    options.robust = false;
    const Calibration c = calibrate(s.nominal, s.train, options);
    const auto frames = static_cast<Eigen::Index>(c.layout.frame_columns());
    expect_spectrum(c.identifiability.before, differences(c, c.start), frames);
    expect_spectrum(c.identifiability.after, differences(c, c.estimate), frames);
  }
}

}  // namespace
