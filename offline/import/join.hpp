// SPDX-License-Identifier: MIT
// Which joints belong to which measured point: by name, by order or by time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "offline/import/rows.hpp"

namespace mdhcal::offline {

enum class JoinBy : std::int32_t { told, id, order, time };

struct JoinOptions {
  JoinBy by = JoinBy::told;      ///< told: by id where names of both agree, else by order where there are as many rows
  double clock_offset_s = 0;     ///< tracker clock minus robot clock [s]
  double max_gap_s = 0.5;        ///< largest distance in time of a joint row from its point [s]
  double still_rad = 1.7453292519943296e-4;  ///< (by time) a joint that differs by more between neighbouring rows moves: 0.01 deg
  double still_m = 1e-5;                     ///< likewise of a prismatic joint
};

/// A measured point with its joints.
struct JoinedRow {
  std::string id;
  std::string target;
  const SourceRow* measured = nullptr;
  Joints joints{};
};

struct Joined {
  std::vector<JoinedRow> rows;   ///< in the order of the joints for several targets, else of the points
  std::vector<std::string> notes;
};

/// Joins the points of one or more exports with a log of joints; `log` is null if the exports state the joints themselves.
/// Of several files with one point a row each is a target if they name the same points (or, by order, if each has as many rows as
/// the log); otherwise they follow on each other. `target_names` names the targets of files.
/// What has no partner is left out and said. Throws InputError if nothing can be joined, or it is not told how.
Joined join(const std::vector<SourceTable>& exports, const SourceTable* log, const Robot& robot, const JoinOptions& options,
            const std::vector<std::string>& target_names);

}  // namespace mdhcal::offline
