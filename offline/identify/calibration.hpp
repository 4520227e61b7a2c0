// SPDX-License-Identifier: MIT
// What is asked of a calibration, and what comes of it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "offline/base/statistics.hpp"
#include "offline/identify/identifiability.hpp"
#include "offline/identify/reduction.hpp"
#include "offline/identify/rotation_figures.hpp"
#include "offline/identify/uncertainty.hpp"

namespace mdhcal::offline {

/// Which of the joint readings are used, where the file has commanded ones (q1_cmd ...) beside those read.
enum class JointReadings : std::int32_t {
  better,     ///< those read, unless the commanded ones are clearly better
  read,
  commanded,
};

struct CalibrationOptions {
  bool fit_base = true;                 ///< --base fit | given
  bool fit_tool = true;                 ///< --tool fit | given
  std::string method = "rpim";          ///< rpim, rpim-train, nc, lsm, gd, gn, lm, ekf
  std::string lambda_rule = "reml";     ///< reml, rpim, rpim-train, l-curve, gcv, cv, discrepancy, quasi-optimality
  std::optional<double> lambda;         ///< --lambda: no rule
  std::optional<double> rotation_noise_mrad;  ///< --rotation-noise: of a rotation about any axis; else it is estimated
  std::optional<double> noise_mm;       ///< --noise: standard deviation an axis where no sigma is stated; else 0.02
  std::string model = "geometry";       ///< --model: auto, geometry, gravity, joints, full (with the method rpim)
  std::uint64_t seed = 1;
  double test_fraction = 0;             ///< --test-fraction, in [0, 1): of the groups, drawn by seed
  std::vector<std::uint32_t> held_out_groups; ///< or these groups of the dataset
  JointReadings joints = JointReadings::better;
  bool robust = true;
  bool cross_validate = true;           ///< predict every training row by a fit that has not seen its group
  std::optional<double> max_residual_mm;///< --max-residual: median position error that counts as explained
  std::string accept;                   ///< --accept: why a result with reasons against it is used all the same
  bool rezero = false;                  ///< --rezero: large zero offsets go into the nominal zeros
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
  bool outlier = false;           ///< training: beyond the outlier threshold; test: gross, see SplitFigures
  Vector3 before_mm{};            ///< predicted minus measured, nominal geometry; a distance's in the first component
  Vector3 after_mm{};
};

/// 95 % bounds of a mean; not finite where there are fewer than two poses to tell them from.
struct Bounds {
  double low = -HUGE_VAL, high = HUGE_VAL;
};

/// Position errors of a set of rows [mm].
struct SplitFigures {
  Statistics before, after;            ///< all rows
  Statistics before_good, after_good;  ///< the rows that are not named; nothing (count 0) if all are
  std::vector<std::string> outliers;   ///< the rows named: id, or id/target with several targets
  std::size_t poses = 0;               ///< rows of one group or of the same joint readings are one pose
  Bounds mean;                         ///< of the mean over poses like these (all rows)
  double predicted_mean_mm = 0;        ///< what the model predicts for the mean of the rows that are not named
};

/// Every training row predicted by a fit that has not seen its pose.
struct CrossValidation {
  std::size_t folds = 0;
  SplitFigures figures;
  RotationFigures rotation;       ///< of the rows that are full poses
  /// Median, over the rows, of the error over the error predicted for it (noise and the parameters' covariance in that
  /// fold); 1 if the model holds all that moves. Never below 1.
  double misfit = 1;
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
  /// What the rules that need no judge say on the problem at the result, the choice that was made first.
  struct Choice {
    std::string rule;
    double lambda = 0, residual_norm = 0, solution_norm = 0;
  };
  std::vector<Choice> choices;
  std::vector<std::string> silent;///< rules without a choice there, and why
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

/// What the covariance predicts for the corrected position at random readings within the joint limits.
struct PredictedAccuracy {
  std::vector<std::array<double, 4>> points;  ///< x, y, z in the robot's base frame, standard deviation [mm]
  double median_mm = 0, p95_mm = 0, max_mm = 0;
  double frames_median_mm = 0;                ///< of base and targets, if the geometry were known
};

/// Which families of parameters entered beside the geometry, and what else was tried.
struct ModelReport {
  std::string asked = "geometry";          ///< --model
  struct Candidate {
    std::string name;
    double error_mm = 0;                   ///< cross-validated over whole poses of the training rows
  };
  std::vector<Candidate> candidates;       ///< the geometry alone first; none where there was nothing to choose
  std::size_t chosen = 0;                  ///< index of a candidate; 0: the geometry alone
  struct Family {
    std::string name;
    double sd = 0;                         ///< prior standard deviation that the measurements suggest
    std::string unit;
  };
  std::vector<Family> families;            ///< of the candidate chosen, if it is not the geometry alone
  std::string sentence;                    ///< what was chosen, and why; empty without candidates
  std::vector<std::string> left_out;       ///< what could not enter, a sentence each
};

/// A zero that --rezero moved into the nominal geometry.
struct ZeroOffset {
  std::int32_t link = 0;          ///< index of the link, from 0
  double offset = 0;              ///< added to its nominal theta [rad], or d [m] of a prismatic joint
};

struct Calibration {
  Robot robot;                    ///< as given, but for the zeros that were moved
  Robot corrected;                ///< what is written to corrected.toml and packed
  std::string method;
  LambdaReport lambda;
  int iterations = 0;
  bool converged = false;
  SplitFigures train;
  std::optional<SplitFigures> test;
  std::optional<CrossValidation> cross_validation;
  RotationFigures train_rotation, test_rotation;  ///< of the rows that are full poses
  std::vector<RowResult> rows;    ///< training rows, then test rows, each in file order
  std::vector<EstimatedParameter> parameters;
  Identifiability identifiability;
  double noise_mm = 0.02;         ///< the noise that was assumed where no sigma is stated
  double residual_unit_mm = 1;    ///< what a scaled residual of 1 stands for: with sigma the rows' mean sigma, else 1 mm
  double scale_mm = 0;            ///< of one axis's residual
  SharedError shared;             ///< of the rows of one pose
  double independent_share = 1;   ///< of the training rows, for what is shared (shared_error.hpp)
  double outlier_threshold_mm = 0;///< error norm of a training row's position beyond which it is an outlier
  ModelReport model;
  double parameters_used = 0;     ///< degrees of freedom of all unknowns, those of base and targets among them
  PredictedAccuracy accuracy;
  std::vector<ZeroOffset> zeros;  ///< what --rezero moved
  std::vector<Dependence> dependences;
  std::vector<std::string> decisions;  ///< what was decided about the unknowns
  std::vector<std::string> notes;      ///< what the reader has to know
  std::vector<std::string> details;    ///< each weak or lost combination of parameters, of which a note names the worst
  std::string contradiction;           ///< why the rotations were left out (rotation_check.hpp); empty: they were not
  std::vector<std::string> reasons;    ///< why the result must not be used; empty: it may
  std::string accepted;                ///< why it is used all the same (--accept)
  std::string verdict;                 ///< a few sentences

  Layout layout;                  ///< the unknowns, in the order of `covariance`
  Estimate start;                 ///< nominal geometry, base and targets fitted
  Estimate estimate;              ///< the result
  Covariance covariance;
  std::vector<std::size_t> training_rows;
  std::vector<double> robust_weight;   ///< one a training row
  Dataset training;               ///< the rows used, missing points left out
  Dataset testing;                ///< likewise; empty without test rows

  bool usable() const { return reasons.empty(); }
  /// Whether blob and corrected.toml are written.
  bool released() const { return usable() || !accepted.empty(); }
  /// The rows that the verdict rests on: held out, else left out of folds, else (a method without folds) the training's.
  const SplitFigures& judged() const { return test ? *test : cross_validation ? cross_validation->figures : train; }
  /// Of the same rows, those that are full poses.
  const RotationFigures& judged_rotation() const {
    return test ? test_rotation : cross_validation ? cross_validation->rotation : train_rotation;
  }
};

}  // namespace mdhcal::offline
