// SPDX-License-Identifier: MIT
// One function a command; each lives in the file of its name and registers itself with the program.
#pragma once

#include <CLI/CLI.hpp>

namespace mdhcal::offline {

void add_simulate(CLI::App& app);
void add_convert(CLI::App& app);

}  // namespace mdhcal::offline
