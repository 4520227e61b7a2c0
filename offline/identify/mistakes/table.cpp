// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numeric>

#include "offline/identify/mistakes/hypothesis.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {

constexpr double quarter_rad = 0.5 * pi;
// All orders of seven joints would be 5040: there, pairs, turns of the whole row and its reversal.
constexpr std::size_t most_permuted = 6;
// Zeros of all joints by quarter turns: 4^5 is what is worth a second.
constexpr std::size_t most_zeros = 5;

using Table = std::vector<Hypothesis>;

std::size_t joint_count(const Job& job) { return static_cast<std::size_t>(job.robot.geometry.joint_count); }

bool revolute(const Job& job, std::size_t joint) {
  return job.robot.geometry.joint[joint].kind == JointKind::revolute;
}

Hypothesis angles_in(bool radians, const Job& job) {
  const double factor = radians ? deg_per_rad : rad_per_deg;
  Hypothesis h;
  h.kind = MistakeKind::angle_unit;
  h.what = radians ? "the joint angles in radians" : "the joint angles in degrees";
  h.cure = std::string("name the columns q1_") + (radians ? "rad, q2_rad, ..." : "deg, q2_deg, ...");
  h.apply = [factor](Job& j) {
    for (Measurement& m : j.data.rows) {
      for (std::size_t i = 0; i < joint_count(j); ++i) {
        if (!revolute(j, i)) continue;
        m.q[i] *= factor;
        if (!(std::fabs(m.q[i]) <= max_reading)) return false;
      }
    }
    return true;
  };
  (void)job;
  return h;
}

void add_units(const Job& job, Table& out) {
  const Dataset& data = job.data;
  if (!data.angles_stated) {
    out.push_back(angles_in(true, job));
    out.push_back(angles_in(false, job));
    for (std::size_t j = 0; j < joint_count(job); ++j) {
      if (!revolute(job, j)) continue;
      for (const bool radians : {true, false}) {
        Hypothesis h = geared(job, j, radians ? deg_per_rad : rad_per_deg);
        h.kind = MistakeKind::reading_unit;
        h.what = reading_name(data, j) + (radians ? " in radians" : " in degrees");
        h.cure = "name the column " + reading_name(data, j) + (radians ? "_rad" : "_deg");
        out.push_back(h);
      }
    }
  }
  for (std::size_t j = 0; j < joint_count(job); ++j) {
    if (revolute(job, j) || data.lengths_stated) continue;
    for (const bool metres : {true, false}) {
      Hypothesis h = geared(job, j, metres ? 1e3 : 1e-3);
      h.kind = MistakeKind::reading_unit;
      h.what = reading_name(data, j) + (metres ? " in metres" : " in millimetres");
      h.cure = "name the column " + reading_name(data, j) + (metres ? "_m" : "_mm");
      out.push_back(h);
    }
  }
}

// The robot file's numbers read another way: unit of angles, convention, both.
void add_readings_of_the_table(const Job& job, Table& out) {
  if (job.robot.text.empty()) return;
  const Robot& robot = job.robot;
  const auto reread = [](const ReadAs& as) {
    return [as](Job& j) {
      const std::optional<Robot> other = read_as(j.robot, as);
      if (!other) return false;
      j.robot = *other;
      return true;
    };
  };
  const std::string unit = robot.angle_in_deg ? "rad" : "deg";
  Hypothesis angle;
  angle.kind = MistakeKind::table_angle_unit;
  angle.first = true;
  angle.what = "the robot file's angles in " + std::string(robot.angle_in_deg ? "radians" : "degrees");
  angle.cure = "set angle_unit = \"" + unit + "\" in the robot file";
  if (!robot.angle_in_deg && !job.data.angles_stated) angle.cure += " and name the columns q1_rad, ... if they are in radians";
  ReadAs as;
  as.angle_in_deg = !robot.angle_in_deg;
  angle.apply = reread(as);
  out.push_back(angle);
  Hypothesis convention;
  convention.kind = MistakeKind::convention;
  convention.first = true;
  const std::string other = robot.standard ? "modified" : "standard";
  convention.what = "the robot file's table read in the " + other + " convention";
  convention.cure = "set convention = \"" + other + "\" in the robot file";
  as = {};
  as.standard = !robot.standard;
  convention.apply = reread(as);
  out.push_back(convention);
  Hypothesis both = angle;
  both.deep = false;
  both.changes = 2;
  both.kind = MistakeKind::convention;
  both.what += " and its table in the " + other + " convention";
  both.cure += "; " + convention.cure;
  as.angle_in_deg = !robot.angle_in_deg;
  both.apply = reread(as);
  out.push_back(both);
}

void add_signs(const Job& job, Table& out) {
  const std::size_t n = joint_count(job);
  for (std::uint32_t mask = 1; mask < (1U << n); ++mask) {
    std::vector<std::size_t> joints;
    for (std::size_t j = 0; j < n; ++j) {
      if ((mask >> j & 1U) != 0) joints.push_back(j);
    }
    // Eight joints: up to three of them.
    if (n > 7 && joints.size() > 3) continue;
    out.push_back(reversed(job, joints));
  }
}

// The zero of the first joint is the base's and that of the last the target's: both are free in the screening.
void add_zeros(const Job& job, Table& out) {
  std::vector<std::size_t> inner;
  for (std::size_t j = 1; j + 1 < joint_count(job); ++j) {
    if (revolute(job, j)) inner.push_back(j);
  }
  const bool all = inner.size() <= most_zeros;
  const std::size_t count = static_cast<std::size_t>(1) << (2 * inner.size());
  for (std::size_t code = 1; code < count; ++code) {
    std::vector<std::pair<std::size_t, double>> turns;
    for (std::size_t k = 0; k < inner.size(); ++k) {
      const std::size_t quarters = code >> (2 * k) & 3U;
      if (quarters != 0) turns.emplace_back(inner[k], quarter_rad * (quarters == 3 ? -1.0 : static_cast<double>(quarters)));
    }
    if (!all && turns.size() > 2) continue;
    Hypothesis h = zero_moved(job, turns);
    h.deep = turns.size() == 1;
    out.push_back(h);
  }
}

// A joint counted from another zero in the other direction: neither change alone helps.
void add_turned_about(const Job& job, Table& out) {
  for (std::size_t j = 1; j + 1 < joint_count(job); ++j) {
    if (!revolute(job, j)) continue;
    for (const double turn : {quarter_rad, -quarter_rad, 2.0 * quarter_rad}) {
      Hypothesis h = reversed(job, {j});
      const Hypothesis zero = zero_moved(job, {{j, turn}});
      h.what += " and " + zero.what;
      h.cure += " and " + zero.cure;
      h.changes = 2;
      h.deep = false;
      h.apply = [sign = h.apply, turned = zero.apply](Job& other) { return sign(other) && turned(other); };
      out.push_back(h);
    }
  }
}

void add_orders(const Job& job, Table& out) {
  const std::size_t n = joint_count(job);
  std::vector<std::size_t> from(n);
  std::iota(from.begin(), from.end(), 0U);
  const std::vector<std::size_t> plain = from;
  if (n <= most_permuted) {
    while (std::next_permutation(from.begin(), from.end())) out.push_back(reordered(job, from));
    return;
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      from = plain;
      std::swap(from[i], from[j]);
      out.push_back(reordered(job, from));
    }
  }
  for (std::size_t shift = 1; shift < n; ++shift) {
    from = plain;
    std::rotate(from.begin(), from.begin() + static_cast<std::ptrdiff_t>(shift), from.end());
    out.push_back(reordered(job, from));
  }
  from.assign(plain.rbegin(), plain.rend());
  out.push_back(reordered(job, from));
}

void add_couplings(const Job& job, Table& out) {
  const std::size_t n = joint_count(job);
  for (std::size_t of = 1; of < n; ++of) {
    for (std::size_t by = 0; by < of; ++by) {
      const double given = job.robot.geometry.joint[of].coupling[by];
      if (std::fabs(given) > 0.0) {
        for (const double ratio : {-given, -2.0 * given}) out.push_back(coupled({{of, by}}, {ratio}));
        continue;
      }
      for (const double ratio : {1.0, -1.0}) out.push_back(coupled({{of, by}}, {ratio}));
    }
  }
  if (n < 6) return;
  // A wrist of hollow shafts: the fourth joint's motor turns the other two along.
  for (const double five : {1.0, -1.0}) {
    for (const double six : {1.0, -1.0}) out.push_back(coupled({{4, 3}, {5, 3}}, {five, six}));
  }
  for (const double five : {1.0, -1.0}) {
    for (const double six : {1.0, -1.0}) out.push_back(coupled({{4, 3}, {5, 4}}, {five, six}));
  }
}

void add_signs_of_the_table(const Job& job, Table& out) {
  for (std::size_t i = 0; i < joint_count(job); ++i) {
    const Link& link = job.robot.geometry.link[i];
    const auto add = [&](MistakeKind kind, double value, double Link::*key, const char* name) {
      constexpr double none = 1e-9;  // a length that the table states as zero [m], an angle likewise [rad]
      if (!(std::fabs(value) > none)) return;
      Hypothesis h;
      h.kind = kind;
      h.what = std::string(name) + " of link " + std::to_string(i + 1) + " of the other sign";
      h.cure = "reverse the sign of " + std::string(name) + " in [[link]] " + std::to_string(i + 1);
      h.apply = [i, key](Job& j) {
        j.robot.geometry.link[i].*key *= -1.0;
        j.robot.nominal[i].*key *= -1.0;
        return true;
      };
      out.push_back(h);
    };
    add(MistakeKind::length_sign, link.a_m, &Link::a_m, "a");
    add(MistakeKind::length_sign, link.d_m, &Link::d_m, "d");
    // Of axes that are parallel as far as files write digits, the twist has no sign.
    constexpr double parallel = 1e-6;
    if (std::fabs(std::sin(link.alpha_rad)) > parallel) add(MistakeKind::twist_sign, link.alpha_rad, &Link::alpha_rad, "alpha");
  }
}

}  // namespace

std::vector<Hypothesis> table_of_mistakes(const Job& job) {
  Table out;
  add_units(job, out);
  add_readings_of_the_table(job, out);
  add_signs(job, out);
  add_zeros(job, out);
  add_turned_about(job, out);
  add_orders(job, out);
  add_couplings(job, out);
  add_signs_of_the_table(job, out);
  for (const int shift : {1, -1}) out.push_back(shifted_rows(job, shift, 0));
  return out;
}

}  // namespace mdhcal::offline
