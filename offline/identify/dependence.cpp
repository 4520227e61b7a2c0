// SPDX-License-Identifier: MIT
#include "offline/identify/dependence.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <functional>

#include "offline/base/distributions.hpp"
#include "offline/base/sentences.hpp"
#include "offline/identify/folds.hpp"
#include "offline/robot/units.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {


// What is regressed: the residuals of the good training rows [mm], each with the value of the quantity.
struct Sample {
  std::vector<std::size_t> row;  // into Dataset::rows
  std::vector<Vector3> residual_mm;
  std::vector<double> quantity;
};

Sample sample_of(const Calibration& c, const std::function<double(std::size_t)>& quantity_of) {
  Sample out;
  for (const RowResult& r : c.rows) {
    if (r.test || r.outlier || c.training.rows[r.row].kind == MeasurementKind::distance) continue;
    const double quantity = quantity_of(r.row);
    if (!std::isfinite(quantity)) continue;
    out.row.push_back(r.row);
    out.residual_mm.push_back(r.after_mm);
    out.quantity.push_back(quantity);
  }
  return out;
}

// Least squares of the residuals on `columns(row)`, 3 x effects in mm per unit, times the quantity about its mean; the
// F test is of all effects together. Repeats of one configuration count as `share` of a row each.
Dependence regress(const Calibration& c, Sample sample, Eigen::Index effects, double share,
                   const std::function<Eigen::MatrixXd(std::size_t)>& columns) {
  Dependence out;
  out.count = sample.row.size();
  if (out.count == 0) return out;
  const auto n = static_cast<double>(out.count);
  double mean = 0;
  for (const double q : sample.quantity) mean += q / n;
  double spread = 0;
  for (double& q : sample.quantity) {
    q -= mean;
    spread += q * q;
  }
  const double freedom = share * 3.0 * n - static_cast<double>(effects) - c.parameters_used;
  if (!(spread > 0.0) || freedom < 3.0) return out;
  const auto rows = static_cast<Eigen::Index>(3 * out.count);
  Eigen::MatrixXd a(rows, effects);
  Eigen::VectorXd b(rows);
  for (std::size_t i = 0; i < out.count; ++i) {
    const auto at = static_cast<Eigen::Index>(3 * i);
    a.middleRows(at, 3) = sample.quantity[i] * columns(sample.row[i]);
    for (Eigen::Index k = 0; k < 3; ++k) b(at + k) = sample.residual_mm[i][static_cast<std::size_t>(k)];
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(a);
  const Eigen::VectorXd effect = qr.solve(b);
  const double rest = (b - a * effect).squaredNorm();
  const double explained = std::max(0.0, b.squaredNorm() - rest);
  const auto rank = static_cast<double>(qr.rank());
  if (!(rest > 0.0) || rank < 1.0) return out;
  out.correlation = std::sqrt(explained / (explained + rest));
  out.p_value = f_upper_tail(explained / rank / (rest / freedom), rank, freedom);
  out.effects.assign(effect.data(), effect.data() + effects);
  return out;
}

void mean_residual(const Calibration& c, const std::function<bool(std::size_t)>& counts, Dependence& out) {
  out.count = 0;
  for (const RowResult& r : c.rows) {
    if (r.test || r.outlier || !counts(r.row)) continue;
    ++out.count;
    for (std::size_t k = 0; k < 3; ++k) out.mean_residual_mm[k] += r.after_mm[k];
  }
  for (double& component : out.mean_residual_mm) component /= std::max(1.0, static_cast<double>(out.count));
}

}  // namespace

Dependence temperature_dependence(const Calibration& c) {
  const auto temperature = [&](std::size_t row) { return c.training.temperature[row]; };
  const Frame<double>& base = c.estimate.tracker_T_base;
  const Vector3 foot{base.position_m[0], base.position_m[1], base.position_m[2]};
  Dependence out = regress(c, sample_of(c, temperature), 4, c.independent_share, [&](std::size_t row) {
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(3, 4);
    columns.leftCols(3).setIdentity();
    const Vector3 reach = minus(c.training.rows[row].position_m, foot);
    for (Eigen::Index k = 0; k < 3; ++k) columns(k, 3) = reach[static_cast<std::size_t>(k)];
    return columns;
  });
  mean_residual(c, [&](std::size_t row) { return std::isfinite(temperature(row)); }, out);
  out.quantity = "temperature";
  return out;
}

std::vector<Dependence> direction_dependences(const Calibration& c) {
  std::vector<std::string> words = c.training.direction;
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  const Geometry& geometry = c.estimate.geometry;
  Layout turns;
  turns.base = turns.target = false;
  for (std::int32_t i = 0; i < geometry.joint_count; ++i) {
    if (geometry.joint[i].kind != JointKind::revolute) continue;
    Parameter turn;
    turn.id = {ParameterKey::theta, i};
    turn.prior = 1e-3;
    turns.geometry.push_back(turn);
  }
  const MeasurementModel model(c.estimate);
  const double share = c.independent_share;
  std::vector<Dependence> out;
  for (const std::string& word : words) {
    const auto stands = [&](std::size_t row) { return c.training.direction[row] == word ? 1.0 : 0.0; };
    Dependence one;
    if (!turns.geometry.empty()) {
      one = regress(c, sample_of(c, stands), static_cast<Eigen::Index>(turns.columns()), share, [&](std::size_t row) {
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> columns(
            max_row_residuals, static_cast<Eigen::Index>(turns.columns()));
        double residual[max_row_residuals];
        model.residual(c.training, row, turns, residual, columns.data(), turns.columns());
        return Eigen::MatrixXd(columns.topRows(3));
      });
    }
    mean_residual(c, [&](std::size_t row) { return stands(row) > 0.5; }, one);
    one.quantity = "direction " + word;
    // Beyond chance counts for all words together (Bonferroni).
    one.p_value = std::min(1.0, one.p_value * static_cast<double>(words.size()));
    out.push_back(one);
  }
  return out;
}

std::vector<std::string> sentences_on(const std::vector<Dependence>& dependences) {
  std::vector<std::string> out;
  for (const Dependence& d : dependences) {
    if (!(d.p_value < dependence_level)) continue;
    std::string text = "The residual goes with " + d.quantity + " (correlation " + number(d.correlation, 2) +
                       ", by chance with probability " + number(d.p_value) + "): ";
    if (d.quantity == "temperature") {
      // The residual is predicted minus measured: the arm does the opposite.
      text += "a unit more shifts the target by " + number(-d.effects[0]) + ", " + number(-d.effects[1]) + ", " +
              number(-d.effects[2]) + " mm and stretches the arm by " + number(-d.effects[3]) +
              " mm a metre. Let the arm warm up, or measure at one temperature";
    } else {
      const auto worst = std::max_element(d.effects.begin(), d.effects.end(),
                                          [](double a, double b) { return std::fabs(a) < std::fabs(b); });
      text += "some joint stands off by " + number(1e-3 * deg_per_rad * std::fabs(*worst)) +
              " degrees there. Approach from one side, or look for backlash";
    }
    out.push_back(text + "; it is in no parameter.");
  }
  return out;
}

}  // namespace mdhcal::offline
