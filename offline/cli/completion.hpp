// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>

namespace mdhcal::offline {

/// Adds `mdhcal completion bash`, which prints a script that completes the commands and options that `app` has when it
/// runs, and the words that an option allows. Call it last.
void add_completion(CLI::App& app);

}  // namespace mdhcal::offline
