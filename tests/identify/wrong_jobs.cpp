// SPDX-License-Identifier: MIT
#include "tests/identify/wrong_jobs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "offline/robot/vectors.hpp"
#include "offline/simulate/family.hpp"
#include "tests/identify/simulated.hpp"

namespace mdhcal::tests {

using namespace offline;

namespace {

constexpr double degree_rad = std::numbers::pi / 180.0;

using Rows = std::vector<Measurement>;

std::size_t joints(const WrongJob& w) { return static_cast<std::size_t>(w.job.robot.geometry.joint_count); }

// The same to the rows to identify from and to the unseen ones.
void both(WrongJob& w, const std::function<void(Measurement&)>& change) {
  for (Rows* rows : {&w.job.data.rows, &w.unseen.rows}) {
    for (Measurement& m : *rows) change(m);
  }
}

void scale_readings(WrongJob& w, double factor) {
  both(w, [&](Measurement& m) {
    for (double& q : m.q) q *= factor;
  });
}

void scale_positions(WrongJob& w, double factor) {
  both(w, [&](Measurement& m) {
    for (double& c : m.position_m) c *= factor;
  });
}

void scale_table(WrongJob& w, double factor) {
  Robot& robot = w.job.robot;
  for (std::size_t i = 0; i < joints(w); ++i) {
    robot.geometry.link[i].a_m *= factor;
    robot.geometry.link[i].d_m *= factor;
    robot.nominal[i] = robot.geometry.link[i];
  }
  for (double& c : *robot.tool_p_m) c *= factor;
  w.job.data.lengths_stated = true;
}

void reread(WrongJob& w, const std::string& text) {
  const Robot robot = parse_robot(text, "r.toml");
  w.job.robot = robot;
}

std::size_t inner_joint(const WrongJob& w, Random& random) { return 1 + random.index(joints(w) - 2); }

std::vector<std::size_t> different(std::size_t count, std::size_t of, Random& random) {
  std::vector<std::size_t> out;
  while (out.size() < count) {
    const std::size_t j = random.index(of);
    if (std::find(out.begin(), out.end(), j) == out.end()) out.push_back(j);
  }
  std::sort(out.begin(), out.end());
  return out;
}

void reverse(WrongJob& w, const std::vector<std::size_t>& set) {
  both(w, [&](Measurement& m) {
    for (std::size_t j : set) m.q[j] = -m.q[j];
  });
}

void shift_zero(WrongJob& w, std::size_t joint, double turn_rad) {
  both(w, [&](Measurement& m) { m.q[joint] += turn_rad; });
}

void permute(WrongJob& w, const std::vector<std::size_t>& from) {
  both(w, [&](Measurement& m) {
    const Joints q = m.q;
    for (std::size_t j = 0; j < from.size(); ++j) m.q[j] = q[from[j]];
  });
}

std::vector<std::size_t> plain_order(const WrongJob& w) {
  std::vector<std::size_t> out;
  for (std::size_t j = 0; j < joints(w); ++j) out.push_back(j);
  return out;
}

// Joint `of` of the arm also turns with joint `by`, which the robot file does not say.
void couple(WrongJob& w, std::size_t of, std::size_t by, double ratio) {
  both(w, [&](Measurement& m) { m.q[of] -= ratio * m.q[by]; });
}

Frame<double> moved_frame(double turn_deg, double shift_mm, Random& random) {
  const auto direction = [&](double length) {
    Vector3 v{random.normal(), random.normal(), random.normal()};
    const double size = norm(v);
    for (double& c : v) c *= length / size;
    return v;
  };
  Frame<double> out = rotation_about(direction(turn_deg * degree_rad), {2.0, 0.5, 1.0});
  const Vector3 shift = direction(1e-3 * shift_mm);
  for (std::size_t k = 0; k < 3; ++k) out.position_m[k] += shift[k];
  return out;
}

void move_rows(Rows& rows, std::size_t from, const Frame<double>& frame) {
  for (std::size_t i = from; i < rows.size(); ++i) rows[i].position_m = transform(frame, rows[i].position_m);
}

// A table as people type it, with its links' alpha and a from `ahead` links further on: 1 makes the standard convention's
// table of a modified arm whose first alpha and a are 0.
std::string typed_table(const Robot& robot, std::int32_t ahead, const std::string& head) {
  std::string text = "name = \"r\"\n" + head;
  const Geometry& g = robot.geometry;
  for (std::int32_t i = 0; i < g.joint_count; ++i) {
    const Link twist = i + ahead < g.joint_count ? g.link[i + ahead] : Link{};
    char line[256];
    std::snprintf(line, sizeof line, "[[link]]\nalpha = %.12f\na = %.12f\nd = %.12f\ntheta = %.12f\n",
                  twist.alpha_rad / degree_rad, 1e3 * twist.a_m, 1e3 * g.link[i].d_m, g.link[i].theta_rad / degree_rad);
    text += line;
  }
  return text + "[tool]\nxyz = [60.0, 40.0, 80.0]\n";
}

// Numbers of a table in radians under a file that does not say so.
std::string radians_unsaid(const Robot& robot) {
  Robot copy = robot;
  copy.angle_in_deg = false;
  for (std::int32_t i = 0; i < copy.geometry.joint_count; ++i) copy.geometry.joint[i].has_min = copy.geometry.joint[i].has_max = 0;
  std::string text = write_robot(copy);
  const std::size_t at = text.find("angle_unit");
  if (at != std::string::npos) text.erase(at, text.find('\n', at) + 1 - at);
  return text;
}

std::vector<MistakeMaker> make_table() {
  std::vector<MistakeMaker> t;
  const auto add = [&](const char* name, std::vector<std::string> kinds, std::function<bool(WrongJob&, Random&)> make) {
    t.push_back({name, std::move(kinds), std::move(make), 0.1});
  };
  const std::string sign = "signs of joints", zero = "zeros of joints", order = "order of the joints";
  const std::string coupling = "coupling", ratio = "gear ratio", mirror = "mirrored frame", timing = "rows shifted";
  const std::string angle = "unit of the joint angles", length = "unit of the measured lengths";
  const std::string table_length = "unit of the robot file's lengths";

  add("readings in radians", {angle}, [](WrongJob& w, Random&) { return scale_readings(w, degree_rad), true; });
  add("readings in degrees", {angle}, [](WrongJob& w, Random&) {
    w.job.robot.angle_in_deg = false;
    return scale_readings(w, 1.0 / degree_rad), true;
  });
  add("positions in metres", {length}, [](WrongJob& w, Random&) { return scale_positions(w, 1e-3), true; });
  add("positions in millimetres", {length}, [](WrongJob& w, Random&) {
    w.job.robot.length_in_mm = false;
    return scale_positions(w, 1e3), true;
  });
  add("positions in inches", {length}, [](WrongJob& w, Random&) { return scale_positions(w, 1.0 / 25.4), true; });
  add("positions in micrometres", {length}, [](WrongJob& w, Random&) { return scale_positions(w, 1e3), true; });
  add("radians and metres", {angle}, [](WrongJob& w, Random&) {
    scale_readings(w, degree_rad);
    return scale_positions(w, 1e-3), true;
  });
  add("radians and inches", {angle}, [](WrongJob& w, Random&) {
    scale_readings(w, degree_rad);
    return scale_positions(w, 1.0 / 25.4), true;
  });
  add("table in radians", {"unit of the robot file's angles"}, [](WrongJob& w, Random&) { return reread(w, radians_unsaid(w.job.robot)), true; });
  add("table in metres", {table_length}, [](WrongJob& w, Random&) { return scale_table(w, 1e-3), true; });
  add("table in millimetres", {table_length}, [](WrongJob& w, Random&) {
    w.job.robot.length_in_mm = false;
    return scale_table(w, 1e3), true;
  });
  add("table in inches", {table_length}, [](WrongJob& w, Random&) { return scale_table(w, 1.0 / 25.4), true; });
  add("one sign", {sign, zero, mirror, "sign of a twist"}, [](WrongJob& w, Random& r) { return reverse(w, different(1, joints(w), r)), true; });
  add("two signs", {sign, zero, mirror, "sign of a twist"}, [](WrongJob& w, Random& r) { return reverse(w, different(2, joints(w), r)), true; });
  add("three signs", {sign, zero, mirror, "sign of a twist"}, [](WrongJob& w, Random& r) { return reverse(w, different(3, joints(w), r)), true; });
  add("zero by a quarter turn", {zero}, [](WrongJob& w, Random& r) { return shift_zero(w, inner_joint(w, r), 90 * degree_rad), true; });
  add("zero by half a turn", {zero, sign, "sign of a twist"}, [](WrongJob& w, Random& r) { return shift_zero(w, inner_joint(w, r), 180 * degree_rad), true; });
  add("two zeros", {zero, sign}, [](WrongJob& w, Random&) {
    shift_zero(w, 1, 90 * degree_rad);
    return shift_zero(w, 2, -90 * degree_rad), true;
  });
  add("zero by five degrees", {zero}, [](WrongJob& w, Random& r) { return shift_zero(w, inner_joint(w, r), 5 * degree_rad), true; });
  add("zero by thirty degrees", {zero}, [](WrongJob& w, Random& r) { return shift_zero(w, inner_joint(w, r), -31 * degree_rad), true; });
  add("neighbours swapped", {order}, [](WrongJob& w, Random& r) {
    std::vector<std::size_t> from = plain_order(w);
    const std::size_t j = r.index(joints(w) - 1);
    std::swap(from[j], from[j + 1]);
    return permute(w, from), true;
  });
  add("two joints swapped", {order}, [](WrongJob& w, Random& r) {
    std::vector<std::size_t> from = plain_order(w);
    const auto pair = different(2, joints(w), r);
    std::swap(from[pair[0]], from[pair[1]]);
    return permute(w, from), true;
  });
  add("three joints turned", {order}, [](WrongJob& w, Random&) {
    if (joints(w) > 6) return false;
    std::vector<std::size_t> from = plain_order(w);
    std::rotate(from.begin() + 1, from.begin() + 2, from.begin() + 4);
    return permute(w, from), true;
  });
  add("joints from flange to base", {order}, [](WrongJob& w, Random&) {
    std::vector<std::size_t> from = plain_order(w);
    std::reverse(from.begin(), from.end());
    return permute(w, from), true;
  });
  for (const int shift : {1, -1}) {
    add(shift > 0 ? "readings a row late" : "readings a row early", {timing}, [shift](WrongJob& w, Random&) {
      const Rows given = w.job.data.rows;
      for (std::size_t i = 0; i < given.size(); ++i) {
        const std::size_t n = given.size();
        w.job.data.rows[i].q = given[(i + n - static_cast<std::size_t>(shift > 0 ? 1 : n - 1)) % n].q;
      }
      return true;
    });
  }
  add("readings slipped in the middle", {timing}, [](WrongJob& w, Random& r) {
    const Rows given = w.job.data.rows;
    for (std::size_t i = given.size() / 3 + r.index(given.size() / 3); i + 1 < given.size(); ++i) w.job.data.rows[i].q = given[i + 1].q;
    w.job.data.rows.pop_back();
    return true;
  });
  add("standard read as modified", {"convention"}, [](WrongJob& w, Random&) { return reread(w, typed_table(w.job.robot, 1, "")), true; });
  add("modified read as standard", {"convention"}, [](WrongJob& w, Random&) {
    return reread(w, typed_table(w.job.robot, 0, "convention = \"standard\"\n")), true;
  });
  add("sign of a", {"sign of a length", sign, zero}, [](WrongJob& w, Random&) {
    for (std::size_t i = 0; i < joints(w); ++i) {
      double& a = w.job.robot.geometry.link[i].a_m;
      if (std::fabs(a) < 1e-6) continue;
      a = -a;
      w.job.robot.nominal[i].a_m = a;
      return true;
    }
    return false;
  });
  add("sign of d", {"sign of a length", sign, zero}, [](WrongJob& w, Random&) {
    for (std::size_t i = joints(w) - 1; i-- > 1;) {
      double& d = w.job.robot.geometry.link[i].d_m;
      if (std::fabs(d) < 1e-6) continue;
      d = -d;
      w.job.robot.nominal[i].d_m = d;
      return true;
    }
    return false;
  });
  add("joint 3 coupled by 2", {coupling}, [](WrongJob& w, Random& r) { return couple(w, 2, 1, r.index(2) == 0 ? 1.0 : -1.0), true; });
  add("last joint coupled by the one before", {coupling}, [](WrongJob& w, Random& r) {
    return couple(w, joints(w) - 1, joints(w) - 2, r.index(2) == 0 ? 1.0 : -1.0), true;
  });
  add("joints 5 and 6 coupled by 4", {coupling}, [](WrongJob& w, Random& r) {
    if (joints(w) < 6) return false;
    couple(w, 4, 3, r.index(2) == 0 ? 1.0 : -1.0);
    return couple(w, 5, 3, r.index(2) == 0 ? 1.0 : -1.0), true;
  });
  add("gear ratio by three per cent", {ratio}, [](WrongJob& w, Random& r) {
    const std::size_t j = inner_joint(w, r);
    return both(w, [&](Measurement& m) { m.q[j] *= 1.03; }), true;
  });
  add("gear ratio by two", {ratio}, [](WrongJob& w, Random& r) {
    const std::size_t j = inner_joint(w, r);
    return both(w, [&](Measurement& m) { m.q[j] *= 0.5; }), true;
  });
  add("a joint that reads a constant", {"constant reading"}, [](WrongJob& w, Random& r) {
    const std::size_t j = inner_joint(w, r);
    return both(w, [&](Measurement& m) { m.q[j] = 0.0; }), true;
  });
  t.back().leaves_mm = 1.0;
  add("y reversed", {mirror}, [](WrongJob& w, Random&) { return both(w, [](Measurement& m) { m.position_m[1] *= -1.0; }), true; });
  add("x and y swapped", {mirror}, [](WrongJob& w, Random&) {
    return both(w, [](Measurement& m) { std::swap(m.position_m[0], m.position_m[1]); }), true;
  });
  add("base given, tilted", {"given base or tool"}, [](WrongJob& w, Random& r) {
    w.job.options.fit_base = false;
    const Frame<double> tilt = moved_frame(0.3, 0.0, r);
    w.job.robot.tracker_T_base = pose_of(compose(tilt, frame_of(*w.job.robot.tracker_T_base)));
    return true;
  });
  add("tool given, wrong", {"given base or tool"}, [](WrongJob& w, Random&) {
    w.job.options.fit_tool = false;
    w.job.robot.tool_p_m = Vector3{};
    return true;
  });
  add("tracker moved in the middle", {"moved tracker"}, [](WrongJob& w, Random& r) {
    return move_rows(w.job.data.rows, w.job.data.rows.size() / 2, moved_frame(0.2, 5.0, r)), true;
  });
  add("tracker moved far", {"moved tracker"}, [](WrongJob& w, Random& r) {
    return move_rows(w.job.data.rows, 2 * w.job.data.rows.size() / 3, moved_frame(20.0, 800.0, r)), true;
  });
  add("tracker moved before the last five rows", {"moved tracker"}, [](WrongJob& w, Random& r) {
    return move_rows(w.job.data.rows, w.job.data.rows.size() - 5, moved_frame(0.1, 2.0, r)), true;
  });
  add("drift of two millimetres", {"drift"}, [](WrongJob& w, Random& r) {
    Rows& rows = w.job.data.rows;
    const Frame<double> whole = moved_frame(0.0, 2.0, r);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        rows[i].position_m[k] += whole.position_m[k] * static_cast<double>(i) / static_cast<double>(rows.size() - 1);
      }
    }
    return true;
  });
  add("a point listed twice, the rest late", {timing, "point listed twice"}, [](WrongJob& w, Random& r) {
    Rows& rows = w.job.data.rows;
    const Rows given = rows;
    for (std::size_t i = rows.size() / 3 + r.index(rows.size() / 3); i < rows.size(); ++i) rows[i].position_m = given[i - 1].position_m;
    return true;
  });
  add("a sign and radians", {angle}, [](WrongJob& w, Random& r) {
    reverse(w, different(1, joints(w), r));
    return scale_readings(w, degree_rad), true;
  });
  add("two joints swapped and a mirror", {mirror}, [](WrongJob& w, Random&) {
    std::vector<std::size_t> from = plain_order(w);
    std::swap(from[1], from[2]);
    permute(w, from);
    return both(w, [](Measurement& m) { m.position_m[2] *= -1.0; }), true;
  });
  add("a sign and a zero", {sign, zero}, [](WrongJob& w, Random&) {
    reverse(w, {2});
    return shift_zero(w, 2, 90 * degree_rad), true;
  });
  add("a coupling and five degrees", {coupling}, [](WrongJob& w, Random&) {
    couple(w, 2, 1, 1.0);
    return shift_zero(w, 1, 5 * degree_rad), true;
  });
  return t;
}

Simulation simulated(const std::string& family, std::size_t poses, std::size_t targets, bool full_pose, double outliers,
                     std::uint64_t seed) {
  SimulationOptions options;
  options.seed = seed;
  options.configurations = poses;
  options.test_configurations = 50;
  options.targets = targets;
  options.full_pose = full_pose;
  options.outlier_fraction = outliers;
  options.outlier_m = 20e-3;
  return simulate(family_robot(family), options);
}

WrongJob job_of(const Simulation& s) {
  WrongJob out;
  out.job.robot = parse_robot(write_robot(s.nominal), "r.toml");
  out.job.robot.tracker_T_base = s.truth.tracker_T_base;
  out.job.data = s.train;
  out.job.data.path = "m.csv";
  out.job.data.angles_stated = out.job.data.lengths_stated = false;
  out.unseen = s.test;
  return out;
}

}  // namespace

const std::vector<MistakeMaker>& mistake_makers() {
  static const std::vector<MistakeMaker> table = make_table();
  return table;
}

WrongJob sound_job(const std::string& family, std::size_t poses, std::uint64_t seed) {
  return job_of(simulated(family, poses, 1, false, 0.0, seed));
}

WrongJob sound_job_of_any_kind(std::uint64_t seed) {
  Random random(seed);
  const std::string family = family_names()[random.index(family_names().size())];
  const std::size_t poses = 6 + random.index(random.index(2) == 0 ? 7 : 55);
  const std::size_t targets = random.index(4) == 0 ? 3 : 1;
  const bool full_pose = random.index(4) == 0;
  const double gross = random.index(3) == 0 ? 0.05 : 0.0;
  const Simulation s = simulated(family, poses, targets, full_pose, gross, seed);
  WrongJob out = job_of(s);
  if (random.index(3) != 0 || targets > 1) return out;
  // Sag: joints 2 and 3 give way to the weight beyond them, some tenths of a milliradian.
  const double two = random.uniform(-6e-4, 6e-4), three = random.uniform(-4e-4, 4e-4);
  const MeasurementModel real = truth_model(s);
  for (Rows* rows : {&out.job.data.rows, &out.unseen.rows}) {
    for (Measurement& m : *rows) {
      Joints q = m.q;
      q[1] += two * std::cos(m.q[1]) + three * std::cos(m.q[1] + m.q[2]);
      q[2] += three * std::cos(m.q[1] + m.q[2]);
      const Vector3 bent = minus(real.target_position(q.data(), 0), real.target_position(m.q.data(), 0));
      m.position_m = plus(m.position_m, bent);
    }
  }
  return out;
}

double unseen_error_mm(const Calibration& calibration, const Dataset& unseen) {
  const MeasurementModel model(calibration.estimate);
  double sum = 0.0;
  for (const Measurement& m : unseen.rows) {
    sum += 1e3 * norm(minus(model.target_position(m.q.data(), m.target), m.position_m));
  }
  return sum / static_cast<double>(unseen.rows.size());
}

}  // namespace mdhcal::tests
