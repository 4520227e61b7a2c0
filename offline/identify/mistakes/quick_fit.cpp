// SPDX-License-Identifier: MIT
#include "offline/identify/mistakes/quick_fit.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "mdhcal/kinematics.hpp"
#include "offline/identify/factorization.hpp"
#include "offline/identify/reduction.hpp"
#include "offline/identify/registration.hpp"
#include "offline/identify/robust.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

// Columns are direction cosines and metres: a direction below a millionth of the largest is noise of the measurements.
constexpr double map_tolerance = 1e-6;
// No tracker tells it: a residual below is rounding [m].
constexpr double nanometre = 1e-9;
// Quadratic convergence from the linear start: two steps reach the digits that a screening needs, the rest reweighs.
constexpr int newton_steps = 5;

using Frames = std::vector<Frame<double>>;

std::vector<Vector3> predicted(const Frames& frames, const std::vector<Sighting>& sightings, const Estimate& estimate) {
  std::vector<Vector3> out;
  out.reserve(sightings.size());
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    out.push_back(transform(frames[i], estimate.flange_p_m[sightings[i].target]));
  }
  return out;
}

std::vector<Vector3> measured(const std::vector<Sighting>& sightings) {
  std::vector<Vector3> out;
  out.reserve(sightings.size());
  for (const Sighting& s : sightings) out.push_back(s.measured_m);
  return out;
}

// base_R_tracker * measured - shift - base_R_flange * target = flange origin, linear in the first, the shift and the
// targets, the first not held to be a rotation: what its singular values and determinant say of lengths and hands.
bool affine_start(const Frames& frames, const std::vector<Sighting>& sightings, QuickFit& out) {
  const std::size_t targets = out.estimate.flange_p_m.size();
  const auto columns = static_cast<Eigen::Index>(12 + 3 * targets);
  const auto rows = static_cast<Eigen::Index>(3 * sightings.size());
  if (rows < columns + 3) return false;
  const std::vector<Vector3> points = measured(sightings);
  // Lengths in any unit: the columns of the measured points are scaled to the size of direction cosines.
  const double unit = spread_of(points);
  if (!(unit > 0.0)) return false;
  Vector3 centre{};
  for (const Vector3& p : points) centre = plus(centre, p);
  for (double& c : centre) c /= static_cast<double>(points.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(rows, columns);
  Eigen::VectorXd b(rows);
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const Vector3 m = minus(points[i], centre);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto r = static_cast<Eigen::Index>(3 * i + k);
      for (std::size_t c = 0; c < 3; ++c) {
        a(r, static_cast<Eigen::Index>(3 * k + c)) = m[c] / unit;
        a(r, static_cast<Eigen::Index>(12 + 3 * sightings[i].target + c)) = -frames[i].rotation[3 * k + c];
      }
      a(r, static_cast<Eigen::Index>(9 + k)) = -1.0;
      b(r) = frames[i].position_m[k];
    }
  }
  const LeastSquares solved = least_squares(a, b, map_tolerance);
  const Eigen::VectorXd x = solved.x;
  Eigen::Matrix3d map;
  for (int k = 0; k < 3; ++k) {
    for (int c = 0; c < 3; ++c) map(k, c) = x(3 * k + c) / unit;
  }
  const SingularVectors svd = full_svd(map);
  if (!(svd.s(2) > 1e-3 * svd.s(0))) return false;
  const Eigen::VectorXd missed = b - a * x;
  for (std::size_t c = 0; c < 3 * targets; ++c) out.estimate.flange_p_m[c / 3][c % 3] = x(static_cast<Eigen::Index>(12 + c));
  out.length_ratio = 1.0 / std::cbrt(svd.s(0) * svd.s(1) * svd.s(2));
  out.mirrored = map.row(0).dot(map.row(1).cross(map.row(2))) < 0.0;
  const double free = static_cast<double>(rows - columns);
  out.affine_misfit = std::sqrt(missed.squaredNorm() / free) / spread_of(predicted(frames, sightings, out.estimate));
  return solved.rank == columns;
}

// One Gauss-Newton step of base (a turn about the points' centre, a shift) and targets.
void newton_step(const Frames& frames, const std::vector<Sighting>& sightings, const std::vector<double>& root_weight,
          Estimate& estimate) {
  const std::size_t targets = estimate.flange_p_m.size();
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(3 * sightings.size()),
                                            static_cast<Eigen::Index>(6 + 3 * targets));
  Eigen::VectorXd b(a.rows());
  Vector3 pivot{};
  for (const Sighting& s : sightings) pivot = plus(pivot, s.measured_m);
  for (double& c : pivot) c /= static_cast<double>(sightings.size());
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const Frame<double> tracker_T_flange = compose(estimate.tracker_T_base, frames[i]);
    const Vector3 p = transform(tracker_T_flange, estimate.flange_p_m[sightings[i].target]);
    const Vector3 arm = minus(p, pivot);
    const double turn[3][3] = {{0.0, arm[2], -arm[1]}, {-arm[2], 0.0, arm[0]}, {arm[1], -arm[0], 0.0}};
    const double w = root_weight.empty() ? 1.0 : root_weight[i];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto r = static_cast<Eigen::Index>(3 * i + k);
      b(r) = w * (sightings[i].measured_m[k] - p[k]);
      for (std::size_t c = 0; c < 3; ++c) {
        a(r, static_cast<Eigen::Index>(c)) = w * turn[k][c];
        a(r, static_cast<Eigen::Index>(6 + 3 * sightings[i].target + c)) = w * tracker_T_flange.rotation[3 * k + c];
      }
      a(r, static_cast<Eigen::Index>(3 + k)) = w;
    }
  }
  const Eigen::VectorXd x = least_squares(a, b, map_tolerance).x;
  const Frame<double> turned = rotation_about({x(0), x(1), x(2)}, pivot);
  estimate.tracker_T_base = orthonormal(compose(turned, estimate.tracker_T_base));
  for (std::size_t k = 0; k < 3; ++k) estimate.tracker_T_base.position_m[k] += x(static_cast<Eigen::Index>(3 + k));
  for (std::size_t c = 0; c < 3 * targets; ++c) {
    estimate.flange_p_m[c / 3][c % 3] += x(static_cast<Eigen::Index>(6 + c));
  }
}

}  // namespace

double spread_of(const std::vector<Vector3>& points) {
  Vector3 mean{};
  for (const Vector3& p : points) mean = plus(mean, p);
  for (double& c : mean) c /= static_cast<double>(points.size());
  double sum = 0.0;
  for (const Vector3& p : points) sum += dot(minus(p, mean), minus(p, mean));
  return std::sqrt(sum / (3.0 * static_cast<double>(points.size())));
}

std::vector<Sighting> sightings_of(const Dataset& data) {
  std::vector<Sighting> out;
  for (const Measurement& m : data.rows) {
    if (m.kind == MeasurementKind::position || m.kind == MeasurementKind::pose) out.push_back({m.q, m.position_m, m.target});
  }
  return out;
}

QuickFit quick_fit(const Estimate& nominal, const std::vector<Sighting>& sightings) {
  QuickFit out;
  out.estimate = nominal;
  Arm<double> arm{};
  if (make_arm(nominal.geometry, arm) != Status::ok || sightings.size() < 4) return out;
  Frames frames;
  frames.reserve(sightings.size());
  Frame<double> along[max_joints + 2];
  for (const Sighting& s : sightings) {
    if (link_frames(arm, s.q.data(), along) != Status::ok) return out;
    frames.push_back(along[arm.joint_count + 1]);
  }
  const std::vector<Vector3> points = measured(sightings);
  if (!affine_start(frames, sightings, out)) out.estimate.flange_p_m = nominal.flange_p_m;
  Estimate estimate = out.estimate;
  estimate.tracker_T_base = rigid_fit(predicted(frames, sightings, estimate), points, {});

  const double scalars = 3.0 * static_cast<double>(sightings.size());
  const double unknowns = 6.0 + 3.0 * static_cast<double>(estimate.flange_p_m.size());
  if (scalars < unknowns + 3.0) return out;
  const double freedom = std::sqrt(scalars / (scalars - unknowns));
  const double spread_measured = spread_of(points);
  std::vector<double> norms(sightings.size());
  std::vector<double> root_weight;
  for (int k = 0; k <= newton_steps; ++k) {
    const std::vector<Vector3> base_p = predicted(frames, sightings, estimate);
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      norms[i] = norm(minus(transform(estimate.tracker_T_base, base_p[i]), points[i])) / chi_median(3);
    }
    const double scale = robust_scale(norms, freedom, nanometre);
    const double misfit = scale / std::min(spread_measured, spread_of(base_p));
    if (misfit < out.misfit) {
      out.misfit = misfit;
      out.scale_m = scale;
      out.estimate = estimate;
    }
    if (k == newton_steps) break;
    root_weight = robust_weights(k == 0 ? Loss::squares : Loss::huber, norms, scale);
    for (double& w : root_weight) w = std::sqrt(w);
    newton_step(frames, sightings, root_weight, estimate);
  }
  return out;
}

}  // namespace mdhcal::offline
