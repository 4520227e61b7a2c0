// SPDX-License-Identifier: MIT
// A whole calibration: from a robot and its measurements to the corrected robot and everything that is said about it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "offline/base/statistics.hpp"
#include "offline/identify/identifiability.hpp"
#include "offline/identify/model.hpp"
#include "offline/identify/uncertainty.hpp"

namespace mdhcal::offline {

struct CalibrationOptions {
  bool fit_base = true;                 ///< --base fit | given
  bool fit_tool = true;                 ///< --tool fit | given
  std::string method = "rpim";          ///< rpim, rpim-train, nc, lsm, gd, gn, lm, ekf
  std::string lambda_rule = "reml";     ///< reml, rpim, rpim-train, l-curve, gcv, cv, discrepancy, quasi-optimality
  std::optional<double> lambda;         ///< --lambda: no rule
  std::optional<double> noise_mm;       ///< --noise: standard deviation an axis where no sigma is stated; else 0.02
  std::uint64_t seed = 1;
  double test_fraction = 0;             ///< --test-fraction, in [0, 1): of the groups, drawn by seed
  std::vector<std::uint32_t> held_out_groups; ///< or these groups of the dataset
  bool commanded_joints = false;        ///< use the commanded readings (q1_cmd ...)
  bool robust = true;
  ParameterChoice parameters;
};

/// One estimated parameter, [rad] or [m].
struct EstimatedParameter {
  ParameterId id{};
  double nominal = 0;
  double deviation = 0;           ///< corrected minus nominal
  double standard_deviation = 0;  ///< noise and the bias of regularization
  double low = 0, high = 0;       ///< 95 % interval of the deviation
  double prior = 0;
  double resolution = 0;          ///< 1: all from the measurements, 0: all from the prior
  bool identifiable = false;
};

/// One measured row and what is left of it.
struct RowResult {
  std::size_t row = 0;            ///< into the training or the test dataset
  bool test = false;
  bool outlier = false;           ///< beyond the outlier threshold
  Vector3 before_mm{};            ///< predicted minus measured, nominal geometry; a distance's in the first component
  Vector3 after_mm{};
};

struct SplitFigures {
  Statistics before, after;            ///< all rows [mm]
  Statistics before_good, after_good;  ///< the rows that are no outliers [mm]
  std::vector<std::string> outliers;     ///< id, or id/target with several targets
};

struct LambdaReport {
  std::string rule;
  double lambda = 0;              ///< [mm^2], [1] with sigma
  std::string note;
  struct Point {
    double lambda, residual_norm, solution_norm, criterion;
  };
  std::vector<Point> curve;       ///< what the rule looked at
  std::vector<Point> l_curve;     ///< the L-curve with its signed curvature
  std::optional<double> corner;   ///< the L-curve's corner, if there is one
};

/// How the residual goes with a recorded quantity (dependence.hpp): reported, not modelled.
struct Dependence {
  std::string quantity;           ///< "temperature", or "direction" with its word
  std::size_t count = 0;          ///< good training rows with the quantity, or with the word
  Vector3 mean_residual_mm{};     ///< over those rows
  double correlation = 0;         ///< multiple correlation of the residual with the quantity, 0 ... 1
  double p_value = 1;             ///< probability that chance alone makes as much
  std::vector<double> effects;    ///< temperature: x, y, z [mm a unit], growth [mm a metre and unit]; direction: [mrad]
                                  ///< a revolute joint
};

struct Calibration {
  Robot robot;                    ///< as given
  Robot corrected;                ///< what is written to corrected.toml and packed
  std::string method;
  LambdaReport lambda;
  int iterations = 0;
  bool converged = false;
  SplitFigures train;
  std::optional<SplitFigures> test;
  std::vector<RowResult> rows;    ///< training rows, then test rows, each in file order
  std::vector<EstimatedParameter> parameters;
  Identifiability identifiability;
  double noise_mm = 0.02;         ///< the noise that was assumed where no sigma is stated
  double residual_unit_mm = 1;    ///< what a scaled residual of 1 stands for: with sigma the rows' mean sigma, else 1 mm
  double scale_mm = 0;            ///< of one axis's residual
  double outlier_threshold_mm = 0;///< error norm of a position beyond which a row is an outlier
  std::vector<Dependence> dependences;
  std::vector<std::string> decisions;  ///< what was decided about the unknowns
  std::vector<std::string> notes;      ///< what the reader has to know
  std::vector<std::string> details;    ///< each weak or lost combination of parameters, of which a note names the worst
  std::string verdict;                 ///< one sentence

  Layout layout;                  ///< the unknowns, in the order of `covariance`
  Estimate start;                 ///< nominal geometry, base and targets fitted
  Estimate estimate;              ///< the result
  Covariance covariance;
  std::vector<std::size_t> training_rows;
  std::vector<double> robust_weight;   ///< one a training row
  Dataset training;               ///< the rows used, missing points left out
  Dataset testing;                ///< likewise; empty without test rows
};

/// Identifies `robot` from `data`. Test rows (of `test`, or drawn by test_fraction) enter nothing but the final figures.
/// Throws InputError for bad input and Refusal where the measurements do not carry a calibration, saying why.
Calibration calibrate(const Robot& robot, const Dataset& data, const CalibrationOptions& options,
                      const Dataset* test = nullptr);

}  // namespace mdhcal::offline
