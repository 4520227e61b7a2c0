// SPDX-License-Identifier: MIT
#include "offline/identify/copies.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace mdhcal::offline {

namespace {

using Content = std::tuple<MeasurementKind, Joints, std::array<double, 3>, std::array<double, 4>, double, Joints>;

Content content_of(const Dataset& data, std::size_t row) {
  const Measurement& m = data.rows[row];
  return {m.kind, m.q, m.position_m, m.quaternion, m.distance_m, row < data.commanded.size() ? data.commanded[row] : Joints{}};
}

template <class Value>
void keep(std::vector<Value>& values, const std::vector<std::size_t>& kept) {
  if (values.empty()) return;
  std::vector<Value> out;
  for (const std::size_t row : kept) out.push_back(std::move(values[row]));
  values = std::move(out);
}

}  // namespace

CountedOnce count_once(const Dataset& given) {
  CountedOnce out;
  std::map<Content, std::size_t> first;
  std::vector<std::size_t> kept;
  std::vector<std::int64_t> twin(given.targets.size(), -1);  // the target that a copy of each one's rows was found under
  std::vector<bool> own(given.targets.size(), false);
  bool linked = false;
  for (std::size_t row = 0; row < given.rows.size(); ++row) {
    const Measurement& m = given.rows[row];
    linked = linked || m.other_row >= 0 || m.kind == MeasurementKind::joints;
    const auto [found, added] = first.emplace(content_of(given, row), row);
    if (added) {
      kept.push_back(row);
      if (m.target < own.size()) own[m.target] = true;
    } else if (m.target < twin.size()) {
      twin[m.target] = static_cast<std::int64_t>(given.rows[found->second].target);
    }
  }
  out.data = given;
  if (linked || kept.size() == given.rows.size()) return out;
  const std::size_t copies = given.rows.size() - kept.size();
  out.note = std::to_string(copies) + (copies == 1 ? " row is a bit-equal copy of another and counts" : " rows are bit-equal copies of others and count") +
             " once.";
  keep(out.data.rows, kept);
  keep(out.data.commanded, kept);
  keep(out.data.temperature, kept);
  keep(out.data.direction, kept);
  std::vector<std::string> targets;
  std::vector<std::uint32_t> number(given.targets.size(), 0);
  for (std::size_t t = 0; t < given.targets.size(); ++t) {
    if (!own[t] && twin[t] >= 0) {
      out.twins.emplace_back(given.targets[t], given.targets[static_cast<std::size_t>(twin[t])]);
      out.note += " Target " + given.targets[t] + " is target " + out.twins.back().second + " once more.";
      continue;
    }
    number[t] = static_cast<std::uint32_t>(targets.size());
    targets.push_back(given.targets[t]);
  }
  out.data.targets = std::move(targets);
  for (Measurement& m : out.data.rows) {
    if (m.target < number.size()) m.target = number[m.target];
  }
  return out;
}

}  // namespace mdhcal::offline
