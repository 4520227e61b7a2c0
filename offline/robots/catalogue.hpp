// SPDX-License-Identifier: MIT
// The catalogue: the nominal kinematics of common arms, a robot file each, compiled into the program.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "offline/embedded.hpp"
#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

/// What the list of the catalogue says of an arm.
struct CatalogueEntry {
  std::string name;
  std::string maker;         ///< its file's line "# maker: "
  std::size_t axes = 0;
  double reach_m = 0;        ///< the largest distance of the flange from the axis of joint 1, within the limits [m]
  std::size_t sources = 0;   ///< its file's lines "# source: ": independent sources that agree
};

/// All arms, sorted by name.
std::vector<CatalogueEntry> catalogue();

/// The catalogue's file that `name` means, or null. Upper case, blanks, '_' and '/' are the same as lower case and '-'.
/// A name is, in this order: the whole name ("kuka-kr210-r2700-2"), the name without the maker
/// ("kr210-r2700-2"), or whole words of it that stand together in one arm's name only ("kr210", "iiwa14").
/// Throws InputError if such words stand in several arms' names, and lists them.
const embedded::File* find_in_catalogue(std::string_view name);

/// Arms whose names share the most with `name`, at most `most`: for messages.
std::vector<std::string> similar_in_catalogue(std::string_view name, std::size_t most);

}  // namespace mdhcal::offline
