// SPDX-License-Identifier: MIT
// The measurement model: what a row should read for a given geometry, base frame and target points, and how that
// changes with every unknown.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "mdhcal/arm.hpp"
#include "offline/identify/families/terms.hpp"
#include "offline/identify/parameters.hpp"
#include "offline/measure/dataset.hpp"

namespace mdhcal::offline {

/// A value of every unknown.
struct Estimate {
  Geometry geometry{};
  Frame<double> tracker_T_base{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  std::vector<Vector3> flange_p_m;  ///< one a target of the dataset
  /// How the probe that measures rotations is turned on the flange, one a target (its position is zero); the identity
  /// for targets beyond the end.
  std::vector<Frame<double>> flange_R_probe;
  Transmission transmission{};  ///< joint functions and sag; zero: none
};

/// The turn of a target's probe.
Frame<double> probe_of(const Estimate& estimate, std::size_t target);

/// Which unknowns there are and in which column each stands: base (rotation [mrad] about `pivot_m`, then translation
/// [mm], both in the tracker frame), the targets (flange frame [mm]), the turns of their probes (about the flange's axes
/// [mrad]), then the geometry and the terms of the transmission, in units of the prior.
struct Layout {
  bool base = true;
  bool target = true;
  std::size_t targets = 1;
  std::vector<std::size_t> probes;  ///< the targets whose probe's turn is fitted
  std::vector<Parameter> geometry;
  std::vector<Term> terms;          ///< joint functions and sag, after the geometry, in units of their prior
  Vector3 pivot_m{};  ///< the point that a base rotation leaves in place, tracker frame

  std::size_t base_columns() const { return base ? 6 : 0; }
  std::size_t target_columns() const { return target ? 3 * targets : 0; }
  std::size_t probe_columns() const { return 3 * probes.size(); }
  std::size_t frame_columns() const { return base_columns() + target_columns() + probe_columns(); }  ///< unpenalised
  std::size_t columns() const { return frame_columns() + geometry.size() + terms.size(); }
};

/// The most scalar residuals of a row of measurements (a full pose).
inline constexpr std::size_t max_row_residuals = 6;

std::size_t residual_count(MeasurementKind kind);

/// An estimate prepared for evaluation.
class MeasurementModel {
 public:
  /// Throws Refusal if the geometry has left the valid range.
  explicit MeasurementModel(const Estimate& estimate);

  const Estimate& estimate() const { return estimate_; }

  /// Position of a target point at the readings q, in the tracker frame [m].
  Vector3 target_position(const double* q, std::size_t target) const;

  /// Predicted minus measured [mm], residual_count() of them: x, y, z in the tracker frame; for a full pose then the
  /// rotation vector of predicted * measured^-1 times data.rotation_lever_mm; for a distance the difference of the lengths.
  /// Not weighted. Returns the count.
  std::size_t residual(const Dataset& data, std::size_t row, double* residual_mm) const;

  /// residual() and its derivative with respect to the unknowns of `layout` [mm per unit of the column], row-major
  /// with `stride` >= layout.columns(). (Li 2022, Eq. 5-7, each column the derivative of one factor)
  std::size_t residual(const Dataset& data, std::size_t row, const Layout& layout, double* residual_mm,
                       double* jacobian, std::size_t stride) const;

 private:
  Estimate estimate_;
  Arm<double> arm_{};
  bool has_functions_ = false, has_sag_ = false;
};

/// The estimate moved by `step` (layout.columns() numbers in the columns' units).
Estimate moved(const Estimate& estimate, const Layout& layout, const double* step);

/// The geometry's deviation from nominal, then the terms, in units of the prior: one number a parameter.
std::vector<double> deviation(const Estimate& estimate, const Layout& layout);

}  // namespace mdhcal::offline
