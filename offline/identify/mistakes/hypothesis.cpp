// SPDX-License-Identifier: MIT
#include "offline/identify/mistakes/hypothesis.hpp"

#include <algorithm>
#include <cmath>

#include "offline/base/sentences.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {

std::string signed_number(double value) { return (value < 0 ? "" : "+") + number(value); }

bool in_range(const Dataset& data) {
  for (const Measurement& m : data.rows) {
    for (std::size_t j = 0; j < data.joint_count; ++j) {
      if (!(std::fabs(m.q[j]) <= max_reading)) return false;
    }
  }
  return true;
}

void scale_table(Robot& robot, double factor) {
  for (std::int32_t i = 0; i < robot.geometry.joint_count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (Link* link : {&robot.geometry.link[i], &robot.nominal[k]}) {
      link->a_m *= factor;
      link->d_m *= factor;
    }
  }
  for (double& c : robot.geometry.last_T_flange.position_m) c *= factor;
  if (robot.tool_p_m) {
    for (double& c : *robot.tool_p_m) c *= factor;
  }
  for (TargetPoint& target : robot.targets) {
    for (double& c : target.flange_p_m) c *= factor;
  }
}

}  // namespace

const char* word(MistakeKind kind) {
  switch (kind) {
    case MistakeKind::angle_unit: return "unit of the joint angles";
    case MistakeKind::length_unit: return "unit of the measured lengths";
    case MistakeKind::reading_unit: return "unit of one joint's reading";
    case MistakeKind::table_angle_unit: return "unit of the robot file's angles";
    case MistakeKind::table_length_unit: return "unit of the robot file's lengths";
    case MistakeKind::convention: return "convention";
    case MistakeKind::order: return "order of the joints";
    case MistakeKind::sign: return "signs of joints";
    case MistakeKind::zero: return "zeros of joints";
    case MistakeKind::ratio: return "gear ratio";
    case MistakeKind::coupling: return "coupling";
    case MistakeKind::length_sign: return "sign of a length";
    case MistakeKind::twist_sign: return "sign of a twist";
    case MistakeKind::mirror: return "mirrored frame";
    case MistakeKind::timing: return "rows shifted";
    case MistakeKind::frame: return "given base or tool";
    case MistakeKind::moved: return "moved tracker";
    case MistakeKind::drift: return "drift";
    case MistakeKind::repeated: return "point listed twice";
    case MistakeKind::stuck: return "constant reading";
    case MistakeKind::rotation: return "convention of rotations";
  }
  return "";
}

bool composable(const Hypothesis& a, const Hypothesis& b) {
  if (a.kind != b.kind) return true;
  switch (a.kind) {
    case MistakeKind::zero:
    case MistakeKind::ratio:
    case MistakeKind::coupling:
    case MistakeKind::length_sign:
    case MistakeKind::twist_sign:
    case MistakeKind::reading_unit: return a.what != b.what;
    default: return false;
  }
}

bool apply_all(const std::vector<const Hypothesis*>& hypotheses, Job& job) {
  for (const bool rows : {true, false}) {
    for (const bool first : {true, false}) {
      for (const Hypothesis* h : hypotheses) {
        if (h->rows == rows && h->first == first && !h->apply(job)) return false;
      }
    }
  }
  return check_geometry(job.robot.geometry) == Status::ok;
}

std::string reading_name(const Dataset& data, std::size_t joint) {
  return joint < data.joint_columns.size() ? data.joint_columns[joint] : "q" + std::to_string(joint + 1);
}

std::string links_in_words(const std::vector<std::size_t>& joints) {
  std::vector<std::string> words;
  for (std::size_t j : joints) words.push_back(std::to_string(j + 1));
  return (joints.size() == 1 ? "link " : "links ") + joined(words);
}

Hypothesis measured_length_unit(double factor, const std::string& words, const std::string& suffix) {
  Hypothesis h;
  h.kind = MistakeKind::length_unit;
  h.what = "the measured positions in " + words;
  h.cure = suffix.empty() ? "convert the positions to millimetres"
                          : "name the columns x" + suffix + ", y" + suffix + ", z" + suffix;
  h.apply = [factor](Job& j) {
    for (Measurement& m : j.data.rows) {
      for (double& c : m.position_m) c *= factor;
      for (double& c : m.sigma_m) c *= factor;
      m.distance_m *= factor;
    }
    return true;
  };
  return h;
}

Hypothesis table_length_unit(double factor, const std::string& words, const std::string& cure) {
  Hypothesis h;
  h.kind = MistakeKind::table_length_unit;
  h.what = "the robot file's lengths in " + words;
  h.cure = cure;
  h.apply = [factor](Job& j) {
    scale_table(j.robot, factor);
    return check_geometry(j.robot.geometry) == Status::ok;
  };
  return h;
}

Hypothesis mirrored_axis(std::size_t axis) {
  Hypothesis h;
  h.kind = MistakeKind::mirror;
  const std::string name(1, static_cast<char>('x' + axis));
  h.what = "the measured frame mirrored (" + name + " reversed)";
  h.cure = "reverse the sign of " + name + " in the measurements, or exchange two axes: the frame is left-handed";
  h.apply = [axis](Job& j) {
    for (Measurement& m : j.data.rows) {
      m.position_m[axis] *= -1.0;
      // A turn about the mirrored axis keeps its sense, those about the other two turn back.
      for (std::size_t k = 0; k < 3; ++k) m.quaternion[k + 1] *= k == axis ? 1.0 : -1.0;
    }
    return true;
  };
  return h;
}

Hypothesis reversed(const Job& job, const std::vector<std::size_t>& joints) {
  Hypothesis h;
  h.kind = MistakeKind::sign;
  std::vector<std::string> names;
  std::vector<std::string> cures;
  for (const int value : {-1, 1}) {
    std::vector<std::size_t> links;
    for (std::size_t j : joints) {
      if (job.robot.geometry.joint[j].sign == -value) links.push_back(j);
    }
    if (!links.empty()) cures.push_back("set sign = " + std::to_string(value) + " in " + links_in_words(links));
  }
  for (std::size_t j : joints) names.push_back(reading_name(job.data, j));
  h.what = joined(names) + " reversed";
  h.cure = joined(cures);
  h.changes = static_cast<int>(joints.size());
  h.apply = [joints](Job& j) {
    for (std::size_t i : joints) j.robot.geometry.joint[i].sign *= -1;
    return true;
  };
  return h;
}

Hypothesis zero_moved(const Job& job, const std::vector<std::pair<std::size_t, double>>& turns_rad) {
  Hypothesis h;
  h.kind = MistakeKind::zero;
  std::vector<std::string> names;
  std::vector<std::string> cures;
  for (const auto& [joint, turn] : turns_rad) {
    const double shown = job.robot.angle_in_deg ? deg_per_rad * turn : turn;
    names.push_back("joint " + std::to_string(joint + 1) + " by " + number(deg_per_rad * turn) + " degrees");
    cures.push_back("add " + signed_number(shown) + " to theta of [[link]] " + std::to_string(joint + 1));
  }
  h.what = "the zero of " + joined(names);
  h.cure = joined(cures);
  h.changes = static_cast<int>(turns_rad.size());
  h.apply = [turns_rad](Job& j) {
    for (const auto& [joint, turn] : turns_rad) {
      for (Link* link : {&j.robot.geometry.link[joint], &j.robot.nominal[joint]}) {
        link->theta_rad = std::remainder(link->theta_rad + turn, 2.0 * pi);
      }
    }
    return true;
  };
  return h;
}

Hypothesis coupled(const std::vector<std::array<std::size_t, 2>>& of_by, const std::vector<double>& ratios) {
  Hypothesis h;
  h.kind = MistakeKind::coupling;
  std::vector<std::string> names;
  std::vector<std::string> cures;
  for (std::size_t k = 0; k < of_by.size(); ++k) {
    const std::string of = std::to_string(of_by[k][0] + 1);
    const std::string by = std::to_string(of_by[k][1] + 1);
    names.push_back("joint " + of + " also turned by " + number(ratios[k]) + " times joint " + by);
    cures.push_back("add " + signed_number(ratios[k]) + " to the ratio of [[coupling]] of = " + of + ", by = " + by +
                    " in the robot file");
  }
  h.what = joined(names);
  h.cure = joined(cures);
  h.changes = static_cast<int>(of_by.size());
  h.apply = [of_by, ratios](Job& j) {
    for (std::size_t k = 0; k < of_by.size(); ++k) j.robot.geometry.joint[of_by[k][0]].coupling[of_by[k][1]] += ratios[k];
    return true;
  };
  return h;
}

Hypothesis geared(const Job& job, std::size_t joint, double factor) {
  Hypothesis h;
  h.kind = MistakeKind::ratio;
  const std::string name = reading_name(job.data, joint);
  h.what = name + " times " + number(factor, 4);
  h.cure = "multiply the column " + name + " by " + number(factor, 5) + ": the gear ratio of joint " +
           std::to_string(joint + 1) + " in the controller is not the arm's";
  h.apply = [joint, factor](Job& j) {
    for (Measurement& m : j.data.rows) m.q[joint] *= factor;
    return in_range(j.data);
  };
  return h;
}

Hypothesis reordered(const Job& job, const std::vector<std::size_t>& from) {
  Hypothesis h;
  h.kind = MistakeKind::order;
  h.changes = 0;
  std::vector<std::string> names;
  std::vector<std::string> moved;
  for (std::size_t j = 0; j < from.size(); ++j) {
    names.push_back(reading_name(job.data, from[j]));
    if (from[j] == j) continue;
    ++h.changes;
    moved.push_back(reading_name(job.data, j));
  }
  if (h.changes == 2) {
    h.what = joined(moved) + " swapped";
    h.cure = "swap the columns " + joined(moved);
  } else {
    std::string row;
    for (std::size_t j = 0; j < names.size(); ++j) row += (j == 0 ? "" : ", ") + names[j];
    h.what = "the joints in the order " + row;
    h.cure = "joints 1 to " + std::to_string(from.size()) + " stand in the columns " + row + ": rename them";
  }
  // Together with others only swaps: of all orders of six joints there are 720.
  h.deep = h.changes == 2;
  h.apply = [from](Job& j) {
    for (Measurement& m : j.data.rows) {
      const Joints q = m.q;
      for (std::size_t i = 0; i < from.size(); ++i) m.q[i] = q[from[i]];
    }
    return true;
  };
  return h;
}

Hypothesis shifted_rows(const Job& job, int shift, std::size_t from) {
  Hypothesis h;
  h.kind = MistakeKind::timing;
  h.rows = true;
  const std::string where = from == 0 ? "" : " from row " + job.data.rows[from].id + " on";
  h.what = std::string("the readings of each row those of the ") + (shift > 0 ? "row before" : "next row") + where;
  h.cure = std::string("move the joint columns ") + (shift > 0 ? "down" : "up") + " by one row" + where +
           ": readings and points are out of step";
  h.apply = [shift, from](Job& j) {
    // Readings move by whole stands of the arm: the rows of several reflectors share them.
    const std::vector<Measurement> given = j.data.rows;
    std::vector<std::size_t> stand(given.size(), 0);
    std::vector<std::size_t> first{0};
    for (std::size_t i = 0; i < given.size(); ++i) {
      if (given[i].kind == MeasurementKind::distance || given[i].kind == MeasurementKind::joints) return false;
      if (i > 0 && given[i].q != given[i - 1].q) first.push_back(i);
      stand[i] = first.size() - 1;
    }
    j.data.rows.clear();
    for (std::size_t i = 0; i < given.size(); ++i) {
      Measurement m = given[i];
      if (i >= from) {
        const std::ptrdiff_t other = static_cast<std::ptrdiff_t>(stand[i]) - shift;
        if (other < 0 || other >= static_cast<std::ptrdiff_t>(first.size())) continue;
        m.q = given[first[static_cast<std::size_t>(other)]].q;
      }
      j.data.rows.push_back(m);
    }
    j.data.commanded.clear();
    j.data.temperature.clear();
    j.data.direction.clear();
    return j.data.rows.size() > 4;
  };
  return h;
}

}  // namespace mdhcal::offline
