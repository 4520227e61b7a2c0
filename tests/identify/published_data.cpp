// SPDX-License-Identifier: MIT
#include "tests/identify/published_data.hpp"

#include "tests/support/program.hpp"
#include "tests/support/shared_data.hpp"

namespace mdhcal::tests {

namespace {

// The shared tables name the measured columns x_meas_mm, ...; reference columns are then unknown ones.
offline::Dataset table(const std::string& name) {
  std::string text = read_bytes(shared_data("li2022/" + name));
  for (std::size_t at = text.find("_meas"); at != std::string::npos; at = text.find("_meas")) text.erase(at, 5);
  return offline::parse_dataset(text, name, li2022_robot());
}

}  // namespace

std::string li2022_robot_text() {
  std::string text = "name = \"li2022\"\n";
  const char* const links[] = {"alpha = 0.0\na = 0.0\nd = 99.927",    "alpha = 90.0\na = 0.0\nd = 106.950",
                               "alpha = 0.0\na = 428.052\nd = 0.0",   "alpha = 0.0\na = 398.551\nd = 0.0",
                               "alpha = -90.0\na = 0.0\nd = 93.160",  "alpha = -90.0\na = 0.0\nd = 81.910"};
  for (const char* link : links) text += std::string("[[link]]\n") + link + "\n";
  return text;
}

offline::Robot li2022_robot() { return offline::parse_robot(li2022_robot_text(), "li2022.toml"); }

offline::Dataset li2022_nine() { return table("nine_poses.csv"); }
offline::Dataset li2022_eighteen() { return table("eighteen_poses.csv"); }
offline::Dataset li2022_all() { return joined(li2022_nine(), li2022_eighteen(), "t8-"); }

offline::Dataset joined(const offline::Dataset& a, const offline::Dataset& b, const std::string& prefix) {
  offline::Dataset out = a;
  for (offline::Measurement m : b.rows) {
    m.id = prefix + m.id;
    m.group += static_cast<std::uint32_t>(a.groups.size());
    out.rows.push_back(m);
  }
  for (const std::string& group : b.groups) out.groups.push_back(prefix + group);
  return out;
}

}  // namespace mdhcal::tests
