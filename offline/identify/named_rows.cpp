// SPDX-License-Identifier: MIT
#include "offline/identify/named_rows.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "offline/base/random.hpp"
#include "offline/base/sentences.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {

// One number or more a row; distances are of their differences.
using Coordinates = std::vector<std::vector<double>>;

double mean_distance(const Coordinates& coordinates, const std::vector<std::size_t>& rows) {
  double sum = 0.0;
  for (std::size_t a = 1; a < rows.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      double squares = 0.0;
      for (const std::vector<double>& c : coordinates) squares += (c[rows[a]] - c[rows[b]]) * (c[rows[a]] - c[rows[b]]);
      sum += std::sqrt(squares);
    }
  }
  return sum;
}

// The share of random choices of as many rows that lie as close together.
double chance(const Coordinates& coordinates, const std::vector<std::size_t>& named, std::size_t count) {
  constexpr int draws = 1999;
  const double seen = mean_distance(coordinates, named);
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  Random random(1);
  int closer = 0;
  std::vector<std::size_t> drawn(named.size());
  for (int k = 0; k < draws; ++k) {
    for (std::size_t i = 0; i < named.size(); ++i) {
      std::swap(order[i], order[i + random.index(count - i)]);
      drawn[i] = order[i];
    }
    closer += mean_distance(coordinates, drawn) <= seen ? 1 : 0;
  }
  return (1.0 + closer) / (1.0 + draws);
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

std::string range_of(const std::vector<double>& values, const std::vector<std::size_t>& rows, bool angle) {
  double low = HUGE_VAL;
  double high = -HUGE_VAL;
  for (const std::size_t row : rows) {
    low = std::min(low, values[row]);
    high = std::max(high, values[row]);
  }
  const double factor = angle ? deg_per_rad : mm_per_m;
  return number(low * factor, 0) + " and " + number(high * factor, 0) + (angle ? " degrees" : " mm");
}

}  // namespace

std::string what_named_rows_share(const Calibration& c, bool test, bool* in_order) {
  if (in_order != nullptr) *in_order = false;
  const Dataset& data = test ? c.testing : c.training;
  const std::size_t joints = data.joint_count;
  Coordinates q(joints);
  std::vector<double> order;
  std::vector<std::size_t> named;
  std::vector<std::string> names;
  for (const RowResult& r : c.rows) {
    if (r.test != test) continue;
    if (r.outlier) named.push_back(order.size()), names.push_back(row_name(data, data.rows[r.row]));
    order.push_back(static_cast<double>(order.size()));
    for (std::size_t j = 0; j < joints; ++j) q[j].push_back(data.rows[r.row].q[j]);
  }
  // With a few hundred rows the test has more power than the sentence needs; its cost grows with the square of the named.
  constexpr std::size_t most = 30;
  if (named.size() < 3 || 2 * named.size() > order.size()) return "";
  std::vector<std::size_t> some;
  for (std::size_t i = 0; i < named.size(); i += 1 + named.size() / most) some.push_back(named[i]);

  const double level = 0.01 / static_cast<double>(2 * joints + 2);
  double least = level;
  std::string place;
  const auto look = [&](const Coordinates& coordinates, const std::string& words) {
    const double p = chance(coordinates, some, order.size());
    if (p < least) least = p, place = words;
  };
  Coordinates scaled = q;
  for (std::vector<double>& one : scaled) {
    const Statistics s = statistics(one);
    for (double& value : one) value /= s.sd > 0.0 ? s.sd : 1.0;
  }
  look({order}, "follow one another in the file (" + names.front() + " to " + names.back() +
                    "): tracker or robot moved there, or drifted");
  const std::string along_the_file = place;
  look(scaled, "are neighbours in joint space: that is error of the model there, not of the measurement");
  for (std::size_t j = 0; j < joints; ++j) {
    const bool angle = c.robot.geometry.joint[j].kind == JointKind::revolute;
    const std::string joint = "joint " + std::to_string(j + 1);
    const std::string tail = ": that is error of the model (gravity, or that joint's own), not of the measurement";
    look({q[j]}, "share the reading of " + joint + ", between " + range_of(q[j], named, angle) + tail);
    const double middle = median(q[j]);
    std::vector<double> far;
    for (const double value : q[j]) far.push_back(std::fabs(value - middle));
    look({far}, "have " + joint + " alike far from the middle of its readings, " + number(middle * (angle ? deg_per_rad : mm_per_m), 0) +
                    (angle ? " degrees" : " mm") + tail);
  }
  if (place.empty()) return "";
  if (in_order != nullptr) *in_order = place == along_the_file;
  return "The " + std::string(test ? "test" : "training") + " rows named (" + std::to_string(named.size()) + " of " +
         std::to_string(order.size()) + ") " + place + ".";
}

}  // namespace mdhcal::offline
