// SPDX-License-Identifier: MIT
#include "offline/identify/parameters.hpp"

#include <algorithm>
#include <cmath>

#include "offline/base/error.hpp"

namespace mdhcal::offline {

namespace {

constexpr const char* key_names[] = {"alpha", "a", "theta", "d", "beta"};
constexpr double half_turn = 3.14159265358979323846;

double* slot(Geometry& geometry, ParameterId id) {
  Link& link = geometry.link[id.link];
  switch (id.key) {
    case ParameterKey::alpha: return &link.alpha_rad;
    case ParameterKey::a: return &link.a_m;
    case ParameterKey::theta: return &link.theta_rad;
    case ParameterKey::d: return &link.d_m;
    case ParameterKey::beta: break;
  }
  return &link.beta_rad;
}

// The angle between the lines of axis i and axis i+1 [rad]: 0 for parallel and for opposed axes. Joint axis i+1 is
// turned against axis i by Ry(beta_i) and Rx(alpha_i), whatever the joint reads.
double angle_to_next_axis(const Geometry& geometry, std::int32_t i) {
  const double cosine = std::cos(geometry.link[i].beta_rad) * std::cos(geometry.link[i + 1].alpha_rad);
  return std::acos(std::min(1.0, std::fabs(cosine)));
}

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

void check_names(const Robot& robot, const std::vector<std::string>& words, const char* option) {
  for (const std::string& word : words) {
    if (parse_parameter(word, robot.geometry.joint_count)) continue;
    throw InputError(std::string(option) + " names \"" + word + "\", which is no parameter of this robot: expected " +
                     "alpha, a, theta, d or beta and a link number from 1 to " +
                     std::to_string(robot.geometry.joint_count) + ", such as alpha2.");
  }
}

}  // namespace

std::string name(ParameterId id) {
  return key_names[static_cast<std::size_t>(id.key)] + std::to_string(id.link + 1);
}

std::optional<ParameterId> parse_parameter(const std::string& word, std::int32_t joint_count) {
  for (std::int32_t link = 0; link < joint_count; ++link) {
    for (std::int32_t key = 0; key < 5; ++key) {
      const ParameterId id{static_cast<ParameterKey>(key), link};
      if (name(id) == word) return id;
    }
  }
  return std::nullopt;
}

bool is_angle(ParameterId id) { return id.key != ParameterKey::a && id.key != ParameterKey::d; }

double value(const Geometry& geometry, ParameterId id) {
  Geometry copy = geometry;
  return *slot(copy, id);
}

void set_value(Geometry& geometry, ParameterId id, double value) { *slot(geometry, id) = value; }

ParameterList choose_parameters(const Robot& robot, const Gauge& gauge, const ParameterChoice& choice) {
  check_names(robot, choice.fix, "--fix");
  check_names(robot, choice.free, "--free");
  const Geometry& geometry = robot.geometry;
  const std::int32_t n = geometry.joint_count;
  for (const auto& [word, prior] : robot.prior) {
    if (!parse_parameter(word, n)) {
      throw InputError(robot.path, 0, 0, "[prior] names \"" + word + "\", which is no parameter of this robot.");
    }
    if (!(prior > 0.0) || !std::isfinite(prior)) {
      throw InputError(robot.path, 0, 0, "[prior] gives " + word + " a standard deviation that is not positive.");
    }
  }

  ParameterList list;
  for (std::int32_t i = 0; i < n; ++i) {
    const double angle = i + 1 < n ? angle_to_next_axis(geometry, i) : 0.5 * half_turn;
    const bool parallel = i + 1 < n && angle <= choice.parallel_rad;
    for (std::int32_t k = 0; k < 5; ++k) {
      const ParameterId id{static_cast<ParameterKey>(k), i};
      const std::string word = name(id);
      bool free = true;
      if (id.key == ParameterKey::beta) {
        free = parallel;
        // Only between parallel revolute axes is d_i confounded; a prismatic axis has no position of its own, so the
        // pair (alpha_{i+1}, beta_i) states its direction and a shift along axis i is still one of d's.
      } else if (id.key == ParameterKey::d) {
        free = !parallel;
      }
      if (gauge.base_fitted && i == 0 && id.key != ParameterKey::beta) free = false;
      // The target takes them up, and so does its probe's turn where rotations are measured.
      if (gauge.target_fitted && i == n - 1 && (id.key == ParameterKey::d || id.key == ParameterKey::theta)) free = false;
      if (contains(choice.free, word)) free = true;
      if (contains(choice.fix, word)) free = false;
      if (!free) continue;
      Parameter parameter;
      parameter.id = id;
      parameter.nominal = value(geometry, id);
      parameter.prior = is_angle(id) ? choice.prior_angle_rad : choice.prior_length_m;
      const auto stated = robot.prior.find(word);
      if (stated != robot.prior.end()) parameter.prior = stated->second;
      list.free.push_back(parameter);
      if (id.key == ParameterKey::beta) list.betas.push_back(word);
    }
    if (parallel) {
      char degrees[32];
      std::snprintf(degrees, sizeof degrees, "%.3f", angle * 180.0 / half_turn);
      list.decisions.push_back("Axes " + std::to_string(i + 1) + " and " + std::to_string(i + 2) +
                               " are parallel within " + degrees + " degrees: beta" + std::to_string(i + 1) +
                               " is estimated, d" + std::to_string(i + 1) + " stays nominal.");
    }
  }
  if (list.betas.empty()) list.decisions.push_back("No neighbouring axes are parallel: every beta stays nominal.");
  if (gauge.base_fitted) {
    list.decisions.push_back("The base frame is fitted: alpha1, a1, theta1 and d1 stay nominal.");
  } else {
    list.decisions.push_back(
        "The base frame is given: link 1 is estimated; a shift of axis 1 along y and a tilt of it about y are not "
        "modelled.");
  }
  if (gauge.target_fitted) {
    const std::string last = std::to_string(n);
    list.decisions.push_back("The target is fitted: d" + last + " and theta" + last + " stay nominal.");
  }
  for (const std::string& word : choice.fix) list.decisions.push_back(word + " is fixed on request.");
  for (const std::string& word : choice.free) list.decisions.push_back(word + " is freed on request.");
  return list;
}

}  // namespace mdhcal::offline
