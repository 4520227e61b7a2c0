// SPDX-License-Identifier: MIT
// One function a command; each lives in the file of its name and registers itself with the program. A command throws
// InputError or Refusal (offline/base/error.hpp), which main() turns into exit status 2 or 1, says things through
// messages.hpp, prints data on stdout, and ends its help with an example: command->footer("Example:\n  mdhcal ...").
#pragma once

#include <CLI/CLI.hpp>

namespace mdhcal::offline {

void add_calibrate(CLI::App& app);
void add_compare(CLI::App& app);
void add_pack(CLI::App& app);
void add_forward(CLI::App& app);
void add_inverse(CLI::App& app);
void add_correct(CLI::App& app);
void add_filter(CLI::App& app);
void add_verify(CLI::App& app);
void add_monitor(CLI::App& app);
void add_show(CLI::App& app);
void add_diff(CLI::App& app);
void add_export(CLI::App& app);
void add_keygen(CLI::App& app);
void add_sign(CLI::App& app);
void add_plan(CLI::App& app);
void add_batch(CLI::App& app);
void add_simulate(CLI::App& app);
void add_convert(CLI::App& app);
void add_robots(CLI::App& app);
void add_import(CLI::App& app);

/// All of them, in the order in which `mdhcal --help` lists them.
inline void add_commands(CLI::App& app) {
  add_calibrate(app);
  add_compare(app);
  add_pack(app);
  add_forward(app);
  add_inverse(app);
  add_correct(app);
  add_filter(app);
  add_verify(app);
  add_monitor(app);
  add_show(app);
  add_diff(app);
  add_export(app);
  add_keygen(app);
  add_sign(app);
  add_plan(app);
  add_batch(app);
  add_simulate(app);
  add_convert(app);
  add_robots(app);
  add_import(app);
}

}  // namespace mdhcal::offline
