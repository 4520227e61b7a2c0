// SPDX-License-Identifier: MIT
#include "offline/robots/catalogue.hpp"

#include <algorithm>
#include <cmath>

#include "mdhcal/arm.hpp"
#include "mdhcal/kinematics.hpp"
#include "offline/base/error.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {

std::string plain(std::string_view name) {
  std::string out;
  for (const char c : name) {
    if (c == ' ' || c == '_' || c == '/') {
      out += '-';
    } else {
      out += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
  }
  return out;
}

std::string_view without_maker(std::string_view name) {
  const std::size_t dash = name.find('-');
  return dash == std::string_view::npos ? name : name.substr(dash + 1);
}

// Whether `words` stands in `name` with a '-' or an end on each side.
bool holds_words(std::string_view name, std::string_view words) {
  for (std::size_t at = name.find(words); at != std::string_view::npos; at = name.find(words, at + 1)) {
    const std::size_t end = at + words.size();
    if ((at == 0 || name[at - 1] == '-') && (end == name.size() || name[end] == '-')) return true;
  }
  return false;
}

// The lines "# KEY: VALUE" of a file.
std::vector<std::string> comment_values(std::string_view text, const std::string& key) {
  std::vector<std::string> values;
  const std::string start = "# " + key + ": ";
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    if (line.starts_with(start)) values.emplace_back(line.substr(start.size()));
    at = end + 1;
  }
  return values;
}

// The largest distance of the flange from the axis of joint 1: one joint after the other is moved to where the distance is
// largest, from coarse steps to fine ones, until no joint gains anything. From two starts, the middle of the limits and
// a bent arm, so that a straight arm's saddle is left.
double reach(const Geometry& geometry) {
  Arm<double> arm;
  if (make_arm(geometry, arm) != Status::ok) return 0;
  const auto distance = [&](const Joints& q) {
    Pose<double> pose{};
    return forward(arm, q.data(), pose) == Status::ok ? std::hypot(pose.position_m[0], pose.position_m[1]) : 0.0;
  };
  double best = 0;
  for (const double bent : {0.0, 0.3}) {
    Joints q{}, low{}, high{};
    const auto count = static_cast<std::size_t>(geometry.joint_count);
    for (std::size_t j = 0; j < count; ++j) {
      const Joint& joint = geometry.joint[j];
      low[j] = joint.has_min != 0 ? std::max(joint.min, -pi) : -pi;
      high[j] = joint.has_max != 0 ? std::min(joint.max, pi) : pi;
      q[j] = 0.5 * (low[j] + high[j]) + bent * 0.5 * (high[j] - low[j]);
    }
    double here = distance(q);
    for (double step = 0.2; step > 1e-4; step *= 0.25) {
      for (bool gained = true; gained;) {
        gained = false;
        for (std::size_t j = 1; j < count; ++j) {
          for (const double by : {step, -step}) {
            Joints moved = q;
            moved[j] = std::clamp(q[j] + by, low[j], high[j]);
            const double there = distance(moved);
            if (there > here + 1e-9) {
              q = moved;
              here = there;
              gained = true;
            }
          }
        }
      }
    }
    best = std::max(best, here);
  }
  return best;
}

}  // namespace

std::vector<CatalogueEntry> catalogue() {
  std::vector<CatalogueEntry> entries;
  for (const embedded::File& file : embedded::robots()) {
    const std::string name(file.name);
    const Robot robot = parse_robot(std::string(file.text), name);
    const auto maker = comment_values(file.text, "maker");
    entries.push_back({name, maker.empty() ? "" : maker.front(), static_cast<std::size_t>(robot.geometry.joint_count),
                       reach(robot.geometry), comment_values(file.text, "source").size()});
  }
  return entries;
}

const embedded::File* find_in_catalogue(std::string_view name) {
  const std::string wanted = plain(name);
  if (wanted.empty()) return nullptr;
  const auto files = embedded::robots();
  for (const embedded::File& file : files) {
    if (file.name == wanted) return &file;
  }
  for (const embedded::File& file : files) {
    if (without_maker(file.name) == wanted) return &file;
  }
  const embedded::File* found = nullptr;
  std::string several;
  for (const embedded::File& file : files) {
    if (!holds_words(file.name, wanted)) continue;
    several += (several.empty() ? "" : ", ") + std::string(file.name);
    if (found != nullptr && several.size() > 400) break;
    found = &file;
  }
  if (found != nullptr && several.find(',') != std::string::npos) {
    throw InputError("Found the robot's name \"" + std::string(name) + "\", which means several in the catalogue: " + several +
                     "; expected one of them.");
  }
  return found;
}

std::vector<std::string> similar_in_catalogue(std::string_view name, std::size_t most) {
  const std::string wanted = plain(name);
  std::vector<std::pair<std::size_t, std::string>> shared;
  for (const embedded::File& file : embedded::robots()) {
    // The longest piece of `wanted` in the arm's name; one or two letters say nothing.
    std::size_t longest = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      while (i + longest < wanted.size() && file.name.find(std::string_view(wanted).substr(i, longest + 1)) != std::string_view::npos) {
        ++longest;
      }
    }
    if (longest > 2) shared.emplace_back(longest, file.name);
  }
  std::stable_sort(shared.begin(), shared.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::string> names;
  for (const auto& [length, similar] : shared) {
    if (names.size() < most) names.push_back(similar);
  }
  return names;
}

}  // namespace mdhcal::offline
