// SPDX-License-Identifier: MIT
#include "offline/identify/registration.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <map>

#include "mdhcal/kinematics.hpp"
#include "offline/identify/factorization.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

// Starting values need no more rows than this; a longer file is thinned evenly.
constexpr std::size_t enough_rows = 2000;
// Columns are direction cosines and metres: a direction below a millionth of the largest is noise of the measurements.
constexpr double start_tolerance = 1e-6;

struct Sight {
  Frame<double> base_T_flange;
  Vector3 measured_m;
  std::size_t target;
  bool turned;                 // the rotation was measured too
  Frame<double> tracker_R_probe;
};

std::vector<Sight> sights(const Dataset& data, const std::vector<std::size_t>& rows, const Arm<double>& arm) {
  std::vector<std::size_t> usable;
  for (std::size_t row : rows) {
    if (data.rows[row].kind != MeasurementKind::distance) usable.push_back(row);
  }
  const std::size_t stride = std::max<std::size_t>(1, usable.size() / enough_rows);
  std::vector<Sight> out;
  for (std::size_t i = 0; i < usable.size(); i += stride) {
    const Measurement& m = data.rows[usable[i]];
    Pose<double> pose{};
    if (forward(arm, m.q.data(), pose) != Status::ok) continue;
    out.push_back({frame_of(pose), m.position_m, m.target, m.kind == MeasurementKind::pose, frame_of(m.quaternion, {})});
  }
  return out;
}

struct NearestRotation {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d s;      // the matrix's singular values: 1, 1, 1 for a rotation
  bool mirrored = false;  // the nearest orthogonal matrix is a reflection
};

NearestRotation nearest_rotation(const Eigen::Matrix3d& matrix) {
  const SingularVectors svd = full_svd(matrix);
  NearestRotation out;
  out.s = svd.s;
  Eigen::Matrix3d guard = Eigen::Matrix3d::Identity();
  out.mirrored = Eigen::Matrix3d(svd.u * svd.v.transpose()).determinant() < 0.0;
  if (out.mirrored) guard(2, 2) = -1.0;
  out.rotation = svd.u * guard * svd.v.transpose();
  return out;
}

void store(const Eigen::Matrix3d& rotation, double* out) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out[3 * i + j] = rotation(i, j);
  }
}

// Base translation and targets for a given base rotation: linear. Least change from the nominal targets where some of
// it cannot be told.
void refit_translations(const std::vector<Sight>& sight, const Layout& layout, Estimate& estimate) {
  const auto base = static_cast<Eigen::Index>(layout.base ? 3 : 0);
  const auto columns = base + static_cast<Eigen::Index>(layout.target_columns());
  if (columns == 0 || sight.empty()) return;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(3 * sight.size()), columns);
  Eigen::VectorXd b(a.rows());
  for (std::size_t i = 0; i < sight.size(); ++i) {
    const Frame<double> tracker_T_flange = compose(estimate.tracker_T_base, sight[i].base_T_flange);
    const Vector3 predicted = transform(tracker_T_flange, estimate.flange_p_m[sight[i].target]);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto r = static_cast<Eigen::Index>(3 * i + k);
      b(r) = sight[i].measured_m[k] - predicted[k];
      if (layout.base) a(r, static_cast<Eigen::Index>(k)) = 1.0;
      if (layout.target) {
        for (std::size_t c = 0; c < 3; ++c) {
          a(r, base + static_cast<Eigen::Index>(3 * sight[i].target + c)) = tracker_T_flange.rotation[3 * k + c];
        }
      }
    }
  }
  const Eigen::VectorXd x = least_squares(a, b, start_tolerance).x;
  for (std::size_t k = 0; k < 3 && layout.base; ++k) {
    estimate.tracker_T_base.position_m[k] += x(static_cast<Eigen::Index>(k));
  }
  for (std::size_t c = 0; c < layout.target_columns(); ++c) {
    estimate.flange_p_m[c / 3][c % 3] += x(base + static_cast<Eigen::Index>(c));
  }
}

// The turn of each probe for a given base rotation: the mean of what each row says.
void refit_probes(const std::vector<Sight>& sight, const Layout& layout, Estimate& estimate) {
  for (const std::size_t probe : layout.probes) {
    std::vector<Frame<double>> flange_R_probe;
    for (const Sight& s : sight) {
      if (!s.turned || s.target != probe) continue;
      flange_R_probe.push_back(compose(inverted(compose(estimate.tracker_T_base, s.base_T_flange)), s.tracker_R_probe));
    }
    estimate.flange_R_probe[probe] = mean_rotation(flange_R_probe);
  }
}

bool joint_linear_start(const std::vector<Sight>& sight, const Layout& layout, Estimate& estimate) {
  const auto columns = static_cast<Eigen::Index>(12 + layout.target_columns());
  if (static_cast<Eigen::Index>(3 * sight.size()) < columns) return false;
  Vector3 centre{};
  for (const Sight& s : sight) centre = plus(centre, s.measured_m);
  for (double& c : centre) c /= static_cast<double>(sight.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(3 * sight.size()), columns);
  Eigen::VectorXd b(a.rows());
  for (std::size_t i = 0; i < sight.size(); ++i) {
    const Vector3 m = minus(sight[i].measured_m, centre);
    for (int k = 0; k < 3; ++k) {
      const auto r = static_cast<Eigen::Index>(3 * i) + k;
      for (int c = 0; c < 3; ++c) a(r, 3 * k + c) = m[static_cast<std::size_t>(c)];
      a(r, 9 + k) = -1.0;
      b(r) = sight[i].base_T_flange.position_m[k];
      if (layout.target) {
        for (int c = 0; c < 3; ++c) {
          a(r, 12 + static_cast<Eigen::Index>(3 * sight[i].target) + c) = -sight[i].base_T_flange.rotation[3 * k + c];
        }
      } else {
        const Vector3 arm = rotate(sight[i].base_T_flange, estimate.flange_p_m[sight[i].target]);
        b(r) += arm[static_cast<std::size_t>(k)];
      }
    }
  }
  const LeastSquares solved = least_squares(a, b, start_tolerance);
  if (solved.rank < columns) return false;
  const Eigen::VectorXd x = solved.x;
  Eigen::Matrix3d base_R_tracker;
  for (int k = 0; k < 3; ++k) {
    for (int c = 0; c < 3; ++c) base_R_tracker(k, c) = x(3 * k + c);
  }
  const NearestRotation nearest = nearest_rotation(base_R_tracker);
  if (nearest.mirrored || !(nearest.s(2) > 0.2) || !(nearest.s(0) < 5.0)) return false;
  const Eigen::Matrix3d& rotation = nearest.rotation;
  const Eigen::Vector3d t = rotation.transpose() * x.segment<3>(9);
  store(rotation.transpose(), estimate.tracker_T_base.rotation);
  for (int k = 0; k < 3; ++k) estimate.tracker_T_base.position_m[k] = t(k) + centre[static_cast<std::size_t>(k)];
  for (std::size_t c = 0; c < layout.target_columns(); ++c) {
    estimate.flange_p_m[c / 3][c % 3] = x(12 + static_cast<Eigen::Index>(c));
  }
  refit_translations(sight, layout, estimate);
  return true;
}

struct Span {
  Vector3 origins_m;             // p_i - p_j
  double rotation[9];            // R_i - R_j
  double length_m;
};

// |dp + dR f|^2 = D^2 is linear in f and in the six products of its components; those are then dropped.
bool target_from_spans(const std::vector<Span>& spans, Vector3& flange_p_m) {
  if (spans.size() < 9) return false;
  Eigen::MatrixXd a(static_cast<Eigen::Index>(spans.size()), 9);
  Eigen::VectorXd b(a.rows());
  for (std::size_t i = 0; i < spans.size(); ++i) {
    const auto r = static_cast<Eigen::Index>(i);
    const Span& s = spans[i];
    const auto column = [&](int c) { return Vector3{s.rotation[c], s.rotation[3 + c], s.rotation[6 + c]}; };
    int next = 3;
    for (int c = 0; c < 3; ++c) {
      a(r, c) = 2.0 * dot(s.origins_m, column(c));
      for (int e = c; e < 3; ++e) a(r, next++) = (c == e ? 1.0 : 2.0) * dot(column(c), column(e));
    }
    b(r) = s.length_m * s.length_m - dot(s.origins_m, s.origins_m);
  }
  const Eigen::VectorXd x = least_squares(a, b, start_tolerance).x;
  for (std::size_t k = 0; k < 3; ++k) {
    flange_p_m[k] = x(static_cast<Eigen::Index>(k));
    if (!(std::fabs(flange_p_m[k]) < 10.0)) return false;
  }
  return true;
}

Span span_between(const Frame<double>& a, const Frame<double>& b, double length_m) {
  Span s{};
  for (int k = 0; k < 9; ++k) s.rotation[k] = a.rotation[k] - b.rotation[k];
  for (std::size_t k = 0; k < 3; ++k) s.origins_m[k] = a.position_m[k] - b.position_m[k];
  s.length_m = length_m;
  return s;
}

bool distance_start(const Dataset& data, const std::vector<std::size_t>& rows, const std::vector<Sight>& sight,
                    const Arm<double>& arm, const Layout& layout, Estimate& estimate) {
  if (!layout.target) return false;
  bool any = false;
  for (std::size_t t = 0; t < layout.targets; ++t) {
    std::vector<Span> spans;
    const Sight* previous = nullptr;
    const Sight* before = nullptr;
    for (const Sight& s : sight) {
      if (s.target != t) continue;
      for (const Sight* other : {previous, before}) {
        if (other == nullptr) continue;
        spans.push_back(span_between(s.base_T_flange, other->base_T_flange,
                                     norm(minus(s.measured_m, other->measured_m))));
      }
      before = previous;
      previous = &s;
    }
    for (std::size_t row : rows) {
      const Measurement& m = data.rows[row];
      if (m.kind != MeasurementKind::distance || m.other_row < 0 || m.target != t) continue;
      const Measurement& end = data.rows[static_cast<std::size_t>(m.other_row)];
      Pose<double> here{};
      Pose<double> there{};
      if (end.target != t || forward(arm, m.q.data(), here) != Status::ok ||
          forward(arm, end.q.data(), there) != Status::ok || spans.size() > 2 * enough_rows) {
        continue;
      }
      spans.push_back(span_between(frame_of(here), frame_of(there), m.distance_m));
    }
    any = target_from_spans(spans, estimate.flange_p_m[t]) || any;
  }
  return any;
}

void register_base(const std::vector<Sight>& sight, const Layout& layout, Estimate& estimate) {
  if (!layout.base || sight.empty()) return;
  std::vector<Vector3> a;
  std::vector<Vector3> b;
  for (const Sight& s : sight) {
    a.push_back(transform(s.base_T_flange, estimate.flange_p_m[s.target]));
    b.push_back(s.measured_m);
  }
  estimate.tracker_T_base = rigid_fit(a, b, {});
}

// Where a draw wire's fixed ends lie in the base frame: |p_i - g|^2 = D_i^2 is linear in g and |g|^2. What is then known
// of them in both frames is registered; with one or two ends the rest of the rotation stays open.
bool fixed_end_start(const Dataset& data, const std::vector<std::size_t>& rows, const Arm<double>& arm,
                     const Layout& layout, Estimate& estimate) {
  if (!layout.base) return false;
  struct End {
    std::vector<Vector3> base_p_m;
    std::vector<double> length_m;
  };
  std::map<Vector3, End> ends;
  for (std::size_t row : rows) {
    const Measurement& m = data.rows[row];
    Pose<double> pose{};
    if (m.kind != MeasurementKind::distance || m.other_row >= 0 || forward(arm, m.q.data(), pose) != Status::ok) continue;
    End& end = ends[m.position_m];
    if (end.length_m.size() >= enough_rows) continue;
    end.base_p_m.push_back(transform(frame_of(pose), estimate.flange_p_m[m.target]));
    end.length_m.push_back(m.distance_m);
  }
  std::vector<Vector3> in_base;
  std::vector<Vector3> in_tracker;
  for (const auto& [fixed_m, end] : ends) {
    const auto n = static_cast<Eigen::Index>(end.length_m.size());
    if (n < 4) continue;
    Eigen::MatrixXd a(n, 4);
    Eigen::VectorXd b(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Vector3& p = end.base_p_m[static_cast<std::size_t>(i)];
      const double length = end.length_m[static_cast<std::size_t>(i)];
      for (Eigen::Index k = 0; k < 3; ++k) a(i, k) = -2.0 * p[static_cast<std::size_t>(k)];
      a(i, 3) = 1.0;
      b(i) = length * length - dot(p, p);
    }
    const LeastSquares solved = least_squares(a, b, start_tolerance);
    if (solved.rank < 4) continue;
    const Eigen::VectorXd g = solved.x;
    in_base.push_back({g(0), g(1), g(2)});
    in_tracker.push_back(fixed_m);
  }
  if (in_base.empty()) return false;
  estimate.tracker_T_base = rigid_fit(in_base, in_tracker, {});
  return true;
}

}  // namespace

Frame<double> rigid_fit(const std::vector<Vector3>& a, const std::vector<Vector3>& b,
                        const std::vector<double>& weight) {
  Eigen::Vector3d mean_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_b = Eigen::Vector3d::Zero();
  double sum = 0.0;
  const auto vector = [](const Vector3& v) { return Eigen::Vector3d(v[0], v[1], v[2]); };
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double w = weight.empty() ? 1.0 : weight[i];
    mean_a += w * vector(a[i]);
    mean_b += w * vector(b[i]);
    sum += w;
  }
  Frame<double> out{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  if (!(sum > 0.0)) return out;
  mean_a /= sum;
  mean_b /= sum;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double w = weight.empty() ? 1.0 : weight[i];
    covariance += w * (vector(b[i]) - mean_b) * (vector(a[i]) - mean_a).transpose();
  }
  const Eigen::Matrix3d rotation = nearest_rotation(covariance).rotation;
  const Eigen::Vector3d t = mean_b - rotation * mean_a;
  store(rotation, out.rotation);
  for (int k = 0; k < 3; ++k) out.position_m[k] = t(k);
  return out;
}

Frame<double> mean_rotation(const std::vector<Frame<double>>& rotations) {
  Frame<double> out{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  if (rotations.empty()) return out;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Frame<double>& each : rotations) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) sum(i, j) += each.rotation[3 * i + j];
    }
  }
  store(nearest_rotation(sum).rotation, out.rotation);
  return out;
}

std::vector<Estimate> starting_values(const Dataset& data, const std::vector<std::size_t>& rows,
                                      const Layout& layout, const Estimate& nominal) {
  Arm<double> arm{};
  if (make_arm(nominal.geometry, arm) != Status::ok) return {nominal};
  const std::vector<Sight> sight = sights(data, rows, arm);
  std::vector<Estimate> out;
  Estimate candidate = nominal;
  if (layout.base && joint_linear_start(sight, layout, candidate)) out.push_back(candidate);
  candidate = nominal;
  if (distance_start(data, rows, sight, arm, layout, candidate)) {
    register_base(sight, layout, candidate);
    refit_translations(sight, layout, candidate);
    out.push_back(candidate);
  }
  candidate = nominal;
  if (fixed_end_start(data, rows, arm, layout, candidate)) out.push_back(candidate);
  candidate = nominal;
  register_base(sight, layout, candidate);
  refit_translations(sight, layout, candidate);
  out.push_back(candidate);
  for (Estimate& each : out) refit_probes(sight, layout, each);
  return out;
}

}  // namespace mdhcal::offline
