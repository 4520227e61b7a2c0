// SPDX-License-Identifier: MIT
#include <Eigen/Core>

#include <algorithm>
#include <cmath>

#include "mdhcal/kinematics.hpp"
#include "offline/base/sentences.hpp"
#include "offline/identify/factorization.hpp"
#include "offline/identify/mistakes/quick_fit.hpp"
#include "offline/identify/mistakes/series.hpp"
#include "offline/identify/registration.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

// Columns are turns and metres: a direction below a millionth of the largest is noise of the measurements.
constexpr double circle_tolerance = 1e-6;
// Readings [rad] of one that did not move, as far as a file writes digits.
constexpr double same_reading = 1e-6;
// No tracker tells a nanometre: a residual below is rounding.
constexpr double rounding_m = 1e-9;

// Each row gives two equations beside its own reading; eight for base and target need nine rows with something over.
constexpr std::size_t least_rows = 8;
constexpr int elimination_steps = 40;
constexpr int starts = 8;

// A target's place as the reading of one revolute joint turns: centre + cosine * cos + sine * sin, each a frame's
// origin and rotation.
struct Circle {
  Frame<double> centre{}, cosine{}, sine{};
};

Frame<double> combined(const Frame<double>& a, double fa, const Frame<double>& b, double fb) {
  Frame<double> out{};
  for (int k = 0; k < 9; ++k) out.rotation[k] = fa * a.rotation[k] + fb * b.rotation[k];
  for (int k = 0; k < 3; ++k) out.position_m[k] = fa * a.position_m[k] + fb * b.position_m[k];
  return out;
}

bool circles(const Arm<double>& arm, const std::vector<Sighting>& sightings, std::size_t joint, std::vector<Circle>& out) {
  constexpr double half_turn = 3.14159265358979323846;
  Frame<double> along[max_joints + 2];
  for (const Sighting& s : sightings) {
    Frame<double> at[3];
    for (int k = 0; k < 3; ++k) {
      Joints q = s.q;
      q[joint] = half_turn * (k == 0 ? 0.0 : k == 1 ? 1.0 : 0.5);
      if (link_frames(arm, q.data(), along) != Status::ok) return false;
      at[k] = along[arm.joint_count + 1];
    }
    Circle c;
    c.centre = combined(at[0], 0.5, at[1], 0.5);
    c.cosine = combined(at[0], 0.5, at[1], -0.5);
    c.sine = combined(at[2], 1.0, c.centre, -1.0);
    out.push_back(c);
  }
  return true;
}

// c cosine + s sine at the target p.
Vector3 on_circle(const Circle& circle, const Vector3& p, double c, double s) {
  return transform(combined(circle.cosine, c, circle.sine, s), p);
}

struct FreeJoint {
  Estimate estimate;
  std::vector<double> angle;
  double scale_m = HUGE_VAL;
};

// Base and targets with the joint's angle of each row as its own unknown: the residual along the circle is projected out.
void refine(const std::vector<Circle>& circle, const std::vector<Sighting>& sightings, FreeJoint& fit) {
  const std::size_t targets = fit.estimate.flange_p_m.size();
  const std::size_t n = sightings.size();
  std::vector<double> norms(n);
  Vector3 pivot{};
  for (const Sighting& s : sightings) pivot = plus(pivot, s.measured_m);
  for (double& c : pivot) c /= static_cast<double>(n);
  Estimate now = fit.estimate;
  for (int round = 0; round <= elimination_steps; ++round) {
    std::vector<double> angle(n);
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(3 * n), static_cast<Eigen::Index>(6 + 3 * targets));
    Eigen::VectorXd b(a.rows());
    const Frame<double> base_T_tracker = inverted(now.tracker_T_base);
    for (std::size_t i = 0; i < n; ++i) {
      const Vector3& f = now.flange_p_m[sightings[i].target];
      const Vector3 off = minus(transform(base_T_tracker, sightings[i].measured_m), transform(circle[i].centre, f));
      const double c = dot(transform(circle[i].cosine, f), off);
      const double s = dot(transform(circle[i].sine, f), off);
      angle[i] = std::atan2(s, c);
      const Frame<double> flange = combined(circle[i].centre, 1.0, combined(circle[i].cosine, std::cos(angle[i]), circle[i].sine,
                                                                           std::sin(angle[i])), 1.0);
      const Frame<double> tracker_T_flange = compose(now.tracker_T_base, flange);
      const Vector3 p = transform(tracker_T_flange, f);
      const Vector3 away = minus(sightings[i].measured_m, p);
      norms[i] = norm(away) / chi_median(3);
      Vector3 tangent = rotate(now.tracker_T_base, on_circle(circle[i], f, -std::sin(angle[i]), std::cos(angle[i])));
      const double length = norm(tangent);
      if (length > 0.0) {
        for (double& t : tangent) t /= length;
      }
      const Vector3 arm = minus(p, pivot);
      Vector3 column[9];
      column[0] = {0.0, -arm[2], arm[1]};
      column[1] = {arm[2], 0.0, -arm[0]};
      column[2] = {-arm[1], arm[0], 0.0};
      for (std::size_t k = 0; k < 3; ++k) {
        column[3 + k] = {};
        column[3 + k][k] = 1.0;
        column[6 + k] = {tracker_T_flange.rotation[k], tracker_T_flange.rotation[3 + k], tracker_T_flange.rotation[6 + k]};
      }
      const auto across = [&](const Vector3& v) {
        const double along = dot(v, tangent);
        return Vector3{v[0] - along * tangent[0], v[1] - along * tangent[1], v[2] - along * tangent[2]};
      };
      for (std::size_t c9 = 0; c9 < 9; ++c9) {
        const Vector3 v = across(column[c9]);
        const std::size_t place = c9 < 6 ? c9 : c9 + 3 * sightings[i].target;
        for (std::size_t k = 0; k < 3; ++k) a(static_cast<Eigen::Index>(3 * i + k), static_cast<Eigen::Index>(place)) = v[k];
      }
      const Vector3 v = across(away);
      for (std::size_t k = 0; k < 3; ++k) b(static_cast<Eigen::Index>(3 * i + k)) = v[k];
    }
    const double scalars = 2.0 * static_cast<double>(n);
    const double unknowns = static_cast<double>(a.cols());
    const double scale = robust_scale(norms, scalars > unknowns + 1.0 ? std::sqrt(scalars / (scalars - unknowns)) : 3.0, rounding_m);
    if (scale < fit.scale_m) {
      fit.scale_m = scale;
      fit.estimate = now;
      fit.angle = angle;
    }
    if (round == elimination_steps) break;
    std::vector<double> weight = robust_weights(Loss::huber, norms, scale);
    for (std::size_t i = 0; i < n; ++i) {
      const double root = std::sqrt(weight[i]);
      for (std::size_t k = 0; k < 3; ++k) {
        a.row(static_cast<Eigen::Index>(3 * i + k)) *= root;
        b(static_cast<Eigen::Index>(3 * i + k)) *= root;
      }
    }
    const Eigen::VectorXd x = least_squares(a, b, circle_tolerance).x;
    // Far from the solution half a radian and the arm's own length bound the step.
    const double size = std::max(x.head(3).norm() / 0.5, x.tail(x.size() - 3).cwiseAbs().maxCoeff() / 0.5);
    const double factor = size > 1.0 ? 1.0 / size : 1.0;
    now.tracker_T_base = orthonormal(compose(rotation_about({factor * x(0), factor * x(1), factor * x(2)}, pivot), now.tracker_T_base));
    for (std::size_t k = 0; k < 3; ++k) now.tracker_T_base.position_m[k] += factor * x(static_cast<Eigen::Index>(3 + k));
    for (std::size_t c = 0; c < 3 * targets; ++c) now.flange_p_m[c / 3][c % 3] += factor * x(static_cast<Eigen::Index>(6 + c));
  }
}

}  // namespace

std::vector<Hypothesis> stuck_joints(const Job& job) {
  std::vector<Hypothesis> out;
  const std::vector<Sighting> sightings = sightings_of(job.data);
  Arm<double> arm{};
  if (make_arm(job.robot.geometry, arm) != Status::ok || sightings.size() < least_rows ||
      sightings.size() != job.data.rows.size()) {
    return out;
  }
  for (std::size_t joint = 0; joint < job.data.joint_count; ++joint) {
    const bool constant = std::all_of(sightings.begin(), sightings.end(), [&](const Sighting& s) {
      return std::fabs(s.q[joint] - sightings.front().q[joint]) < same_reading;
    });
    if (!constant || job.robot.geometry.joint[joint].kind != JointKind::revolute) continue;
    std::vector<Circle> circle;
    if (!circles(arm, sightings, joint, circle)) continue;
    FreeJoint best;
    for (int start = 0; start < starts; ++start) {
      std::vector<Sighting> turned = sightings;
      for (Sighting& s : turned) s.q[joint] += 0.78539816339744831 * start;
      Estimate nominal;
      nominal.geometry = job.robot.geometry;
      nominal.flange_p_m.assign(std::max<std::size_t>(1, job.data.targets.size()), job.robot.tool_p_m.value_or(Vector3{}));
      FreeJoint fit;
      fit.estimate = quick_fit(nominal, turned).estimate;
      refine(circle, sightings, fit);
      if (fit.scale_m < best.scale_m) best = fit;
    }
    if (best.angle.empty()) continue;
    Hypothesis h;
    h.kind = MistakeKind::stuck;
    h.rows = true;
    const std::string name = reading_name(job.data, joint);
    h.what = name + ", the same in every row, taken as unknown";
    h.cure = "record " + name + " again: joint " + std::to_string(joint + 1) + " moved, but its reading is a constant";
    const std::vector<double> angle = best.angle;
    h.apply = [angle, joint](Job& j) {
      if (j.data.rows.size() != angle.size()) return false;
      for (std::size_t i = 0; i < angle.size(); ++i) j.data.rows[i].q[joint] = angle[i];
      return true;
    };
    out.push_back(h);
  }
  return out;
}

}  // namespace mdhcal::offline
