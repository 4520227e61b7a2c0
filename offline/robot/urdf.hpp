// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "offline/robot/chain.hpp"

namespace mdhcal::offline {

/// The chain of moving joints between two links of a URDF; fixed joints are merged into their neighbours. An empty
/// `base` is the root link, an empty `tip` the only leaf below it. Axes may point anywhere.
/// Throws InputError naming file, line and column: no XML, xacro not yet expanded, an unknown link, several leaves and
/// no tip named, a floating, planar or mimic joint on the way, a malformed number.
Chain read_urdf(const std::string& path, const std::string& base = "", const std::string& tip = "");
Chain parse_urdf(const std::string& text, const std::string& path, const std::string& base, const std::string& tip);

/// A robot's geometry as a URDF of frames and joints, without shapes or masses: base_link, link_1 ... link_N, flange
/// and, with a tool point, tool. A robot with a [base] gets a root link `world` in the frame of the measurements.
/// Throws Refusal if a joint is coupled.
std::string urdf_text(const Robot& robot);

/// The URDF `text` with its joints' origins corrected: base_T_tip becomes what robot.geometry says, and each link
/// frame stays at its place on its joint's axis, so that shapes and masses stay where they were. robot.nominal must be
/// the geometry of `text` between `base` and `tip` (InputError otherwise): the calibration of what was read from it.
std::string corrected_urdf(const std::string& text, const std::string& path, const Robot& robot,
                           const std::string& base, const std::string& tip);

}  // namespace mdhcal::offline
