// SPDX-License-Identifier: MIT
#include "offline/identify/mistakes/continuous.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

#include "mdhcal/kinematics.hpp"
#include "offline/base/sentences.hpp"
#include "offline/robot/units.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

constexpr std::size_t most_refined = 6;
constexpr int refinements = 5;
// A column of which less than this is left beside the others says nothing of its own.
constexpr double own_share = 1e-6;

enum class ExtraKind : std::int32_t { zero, ratio, coupling, zeros, drift };

struct Extra {
  ExtraKind kind = ExtraKind::zero;
  std::size_t joint = 0;
  std::size_t by = 0;
};

std::size_t columns_of(const Extra& extra, std::size_t joints) {
  if (extra.kind == ExtraKind::zeros) return joints;
  return extra.kind == ExtraKind::drift ? 6 : 1;
}

// How the residuals of one row change with the readings and with the base, both in the tracker frame [mm].
struct RowSlopes {
  std::size_t begin = 0, count = 0;                  // of the row's scalars
  std::vector<std::array<double, 6>> reading;        // one a joint [mm/rad or mm/m], weighted
  std::array<std::array<double, 6>, 6> base{};       // turn [rad] about the pivot, shift [m]
  Joints q{};
  double time = 0;                                   // 0 at the first row, 1 at the last
};

class Linear {
 public:
  Linear(const Job& few, const Judgement& at)
      : joints_(few.data.joint_count), lever_mm_(few.data.rotation_lever_mm) {
    const MeasurementModel model(at.fit.estimate);
    Arm<double> arm{};
    (void)make_arm(at.fit.estimate.geometry, arm);
    const auto p = static_cast<Eigen::Index>(at.layout.columns());
    const auto frames = static_cast<Eigen::Index>(at.layout.frame_columns());
    std::size_t scalars = 0;
    for (std::size_t row : at.selection.rows) scalars += residual_count(few.data.rows[row].kind);
    const auto m = static_cast<Eigen::Index>(scalars);
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(m + p - frames, p);
    residual_ = Eigen::VectorXd::Zero(a.rows());
    const bool any_sigma = states_sigma(few.data);
    const double noise_mm = few.options.noise_mm.value_or(0.02);
    const double last = std::max<double>(1.0, static_cast<double>(few.data.rows.size() - 1));
    std::vector<double> jacobian(max_row_residuals * at.layout.columns());
    std::size_t next = 0;
    for (std::size_t i = 0; i < at.selection.rows.size(); ++i) {
      const std::size_t row = at.selection.rows[i];
      const Measurement& measurement = few.data.rows[row];
      double r[max_row_residuals];
      double scale[max_row_residuals];
      const std::size_t count = model.residual(few.data, row, at.layout, r, jacobian.data(), at.layout.columns());
      residual_scale(few.data, row, noise_mm, any_sigma, scale);
      const double root = at.selection.robust_weight.empty() ? 1.0 : std::sqrt(at.selection.robust_weight[i]);
      for (std::size_t k = 0; k < count; ++k) {
        const auto line = static_cast<Eigen::Index>(next + k);
        residual_(line) = scale[k] * root * r[k];
        for (Eigen::Index c = 0; c < p; ++c) a(line, c) = scale[k] * root * jacobian[k * at.layout.columns() + static_cast<std::size_t>(c)];
        scale[k] *= root;
      }
      if (measurement.kind != MeasurementKind::distance) add_slopes(few, at, arm, row, next, count, scale, static_cast<double>(row) / last);
      next += count;
    }
    const std::vector<double> x = deviation(at.fit.estimate, at.layout);
    const double noise = any_sigma ? 1.0 : noise_mm;
    for (Eigen::Index g = 0; g < p - frames; ++g) {
      a(m + g, frames + g) = noise;
      residual_(m + g) = noise * x[static_cast<std::size_t>(g)];
    }
    qr_.compute(a);
    residual_ = beside(residual_);
  }

  /// The extra's numbers that take most off the residual, and by how much they lessen its square.
  double reduction(const Extra& extra, Eigen::VectorXd& number) const {
    const auto k = static_cast<Eigen::Index>(columns_of(extra, joints_));
    Eigen::MatrixXd c = Eigen::MatrixXd::Zero(residual_.size(), k);
    for (const RowSlopes& row : rows_) {
      for (std::size_t s = 0; s < row.count; ++s) {
        const auto line = static_cast<Eigen::Index>(row.begin + s);
        switch (extra.kind) {
          case ExtraKind::zero: c(line, 0) = row.reading[extra.joint][s]; break;
          case ExtraKind::ratio: c(line, 0) = row.reading[extra.joint][s] * row.q[extra.joint]; break;
          case ExtraKind::coupling: c(line, 0) = row.reading[extra.joint][s] * row.q[extra.by]; break;
          case ExtraKind::zeros:
            for (std::size_t j = 0; j < joints_; ++j) c(line, static_cast<Eigen::Index>(j)) = row.reading[j][s];
            break;
          case ExtraKind::drift:
            for (std::size_t b = 0; b < 6; ++b) c(line, static_cast<Eigen::Index>(b)) = row.base[b][s] * row.time;
            break;
        }
      }
    }
    number = Eigen::VectorXd::Zero(k);
    Eigen::MatrixXd own = c;
    for (Eigen::Index j = 0; j < k; ++j) {
      own.col(j) = beside(c.col(j));
      if (own.col(j).norm() < own_share * c.col(j).norm()) own.col(j).setZero();
    }
    if (!(own.norm() > 0.0)) return 0.0;
    number = Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(own).solve(-residual_);
    return residual_.squaredNorm() - (residual_ + own * number).squaredNorm();
  }

 private:
  // What of a vector the other unknowns do not reach.
  Eigen::VectorXd beside(const Eigen::VectorXd& v) const {
    Eigen::VectorXd w = qr_.householderQ().transpose() * v;
    w.head(qr_.rank()).setZero();
    return qr_.householderQ() * w;
  }

  void add_slopes(const Job& few, const Judgement& at, const Arm<double>& arm, std::size_t row, std::size_t begin,
                  std::size_t count, const double* weight, double time) {
    const Measurement& m = few.data.rows[row];
    const Estimate& estimate = at.fit.estimate;
    Pose<double> pose{};
    Jacobian<double> jacobian{};
    if (forward(arm, m.q.data(), pose, jacobian) != Status::ok) return;
    const Frame<double> flange = frame_of(pose);
    const Vector3 arm_p = rotate(flange, estimate.flange_p_m[m.target]);
    RowSlopes slopes;
    slopes.begin = begin;
    slopes.count = count;
    slopes.q = m.q;
    slopes.time = time;
    for (std::size_t j = 0; j < joints_; ++j) {
      const double* column = jacobian.column[j];
      const Vector3 turn{column[3], column[4], column[5]};
      const Vector3 shift = plus({column[0], column[1], column[2]}, cross(turn, arm_p));
      slopes.reading.push_back(weighted(rotate(estimate.tracker_T_base, shift), rotate(estimate.tracker_T_base, turn), weight));
    }
    const Vector3 from_pivot = minus(transform(estimate.tracker_T_base, transform(flange, estimate.flange_p_m[m.target])),
                                     at.layout.pivot_m);
    for (std::size_t k = 0; k < 3; ++k) {
      Vector3 axis{};
      axis[k] = 1.0;
      slopes.base[k] = weighted(cross(axis, from_pivot), axis, weight);
      slopes.base[3 + k] = weighted(axis, {}, weight);
    }
    rows_.push_back(slopes);
  }

  std::array<double, 6> weighted(const Vector3& shift_m, const Vector3& turn_rad, const double* weight) const {
    std::array<double, 6> out{};
    for (std::size_t k = 0; k < 3; ++k) {
      out[k] = weight[k] * mm_per_m * shift_m[k];
      out[3 + k] = weight[3 + k] * lever_mm_ * turn_rad[k];
    }
    return out;
  }

  std::size_t joints_;
  double lever_mm_;  // what a turn counts as, see Dataset
  Eigen::VectorXd residual_;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr_;
  std::vector<RowSlopes> rows_;
};

std::vector<Extra> extras(const Job& job) {
  std::vector<Extra> out;
  const std::size_t n = job.data.joint_count;
  for (std::size_t j = 0; j < n; ++j) {
    if (job.robot.geometry.joint[j].kind == JointKind::revolute) out.push_back({ExtraKind::zero, j, 0});
    out.push_back({ExtraKind::ratio, j, 0});
    for (std::size_t by = 0; by < n; ++by) {
      if (by != j) out.push_back({ExtraKind::coupling, j, by});
    }
  }
  out.push_back({ExtraKind::zeros, 0, 0});
  out.push_back({ExtraKind::drift, 0, 0});
  return out;
}

// A ratio that gears have is taken for it: within half a per cent of a whole number of quarters.
double nearest_ratio(double ratio) {
  const double quarter = std::round(4.0 * ratio) / 4.0;
  return std::fabs(ratio - quarter) < 0.005 && std::fabs(quarter) > 0.0 ? quarter : ratio;
}

// The numbers found so far as a hypothesis; `number` is in the readings' sense.
Hypothesis hypothesis_of(const Job& job, const Extra& extra, const Eigen::VectorXd& number, const Vector3& pivot_m) {
  const auto sign = [&](std::size_t j) { return static_cast<double>(job.robot.geometry.joint[j].sign); };
  switch (extra.kind) {
    case ExtraKind::zero: {
      Hypothesis h = zero_moved(job, {{extra.joint, sign(extra.joint) * number(0)}});
      h.cure = "use --rezero, which moves it into the robot's nominal zero, or " + h.cure;
      return h;
    }
    case ExtraKind::ratio: return geared(job, extra.joint, 1.0 + number(0));
    case ExtraKind::coupling: return coupled({{extra.joint, extra.by}}, {nearest_ratio(sign(extra.joint) * number(0))});
    case ExtraKind::zeros: {
      std::vector<std::pair<std::size_t, double>> turns;
      for (std::size_t j = 0; j < job.data.joint_count; ++j) {
        const double turn = number(static_cast<Eigen::Index>(j));
        // Under half a degree it is a deviation, which the calibration estimates.
        if (job.robot.geometry.joint[j].kind == JointKind::revolute && std::fabs(turn) > 0.5 * rad_per_deg) {
          turns.emplace_back(j, sign(j) * turn);
        }
      }
      if (turns.empty()) return {};
      Hypothesis h = zero_moved(job, turns);
      h.cure = "use --rezero, which moves them into the robot's nominal zeros, or " + h.cure;
      return h;
    }
    case ExtraKind::drift: break;
  }
  return drifting(job, {number(0), number(1), number(2)}, {number(3), number(4), number(5)}, pivot_m);
}

}  // namespace

Hypothesis drifting(const Job& job, const Vector3& turn_rad, const Vector3& shift_m, const Vector3& pivot_m) {
  Hypothesis h;
  h.kind = MistakeKind::drift;
  h.rows = true;
  h.what = "the tracker drifting by " + number(mm_per_m * norm(shift_m)) + " mm and " + number(deg_per_rad * norm(turn_rad), 3) +
           " degrees from the first row to the last";
  h.cure = "let tracker and foot settle and measure again, or bring the rows into one frame by reference points";
  (void)job;
  h.apply = [=](Job& j) {
    const double last = std::max<double>(1.0, static_cast<double>(j.data.rows.size() - 1));
    for (std::size_t i = 0; i < j.data.rows.size(); ++i) {
      Measurement& m = j.data.rows[i];
      if (m.kind == MeasurementKind::distance || m.kind == MeasurementKind::joints) continue;
      const double time = static_cast<double>(i) / last;
      // The numbers move the prediction: the measurement goes back by as much.
      Frame<double> back = rotation_about({-time * turn_rad[0], -time * turn_rad[1], -time * turn_rad[2]}, pivot_m);
      Vector3 p = m.position_m;
      for (std::size_t k = 0; k < 3; ++k) p[k] -= time * shift_m[k];
      m.position_m = transform(back, p);
      if (m.kind == MeasurementKind::pose) {
        const Pose<double> turned = pose_of(compose(back, frame_of(m.quaternion, Vector3{})));
        for (std::size_t k = 0; k < 4; ++k) m.quaternion[k] = turned.quaternion[k];
      }
    }
    return true;
  };
  return h;
}

std::vector<Hypothesis> continuous_mistakes(const Job& job, const Judgement& at) {
  std::vector<Hypothesis> out;
  if (!(at.scale_mm < HUGE_VAL)) return out;
  const Job few = thinned(job, judging_rows);
  struct Found {
    Extra extra;
    Eigen::VectorXd number;
    double reduction;
  };
  std::vector<Found> found;
  const Linear linear(few, at);
  for (const Extra& extra : extras(job)) {
    Found f{extra, {}, 0.0};
    f.reduction = linear.reduction(extra, f.number);
    if (f.reduction > 0.0 && f.number.allFinite()) found.push_back(f);
  }
  std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return a.reduction > b.reduction; });
  if (found.size() > most_refined) found.resize(most_refined);
  for (Found& f : found) {
    double best = HUGE_VAL;
    Hypothesis kept;
    for (int round = 0; round < refinements; ++round) {
      const Hypothesis h = hypothesis_of(job, f.extra, f.number, at.layout.pivot_m);
      Job changed = few;
      if (!h.apply || !h.apply(changed)) break;
      const Judgement now = judge(changed);
      if (!(now.scale_mm < HUGE_VAL)) break;
      if (now.scale_mm < best) {
        kept = h;
        const bool settled = now.scale_mm > 0.98 * best;
        best = now.scale_mm;
        if (settled) break;
      }
      Eigen::VectorXd more;
      if (!(Linear(changed, now).reduction(f.extra, more) > 0.0) || !more.allFinite()) break;
      f.number = f.extra.kind == ExtraKind::ratio ? Eigen::VectorXd((f.number.array() + 1.0) * (more.array() + 1.0) - 1.0)
                                                  : Eigen::VectorXd(f.number + more);
    }
    if (!(best < HUGE_VAL)) continue;
    ++kept.changes;  // a number says more than a choice
    out.push_back(kept);
  }
  return out;
}

}  // namespace mdhcal::offline
