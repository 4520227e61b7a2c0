// SPDX-License-Identifier: MIT
#include "offline/cli/commands.hpp"

int main(int argc, char** argv) {
  CLI::App app{"mdhcal: calibrate an arm on the host, correct it in the controller"};
  app.require_subcommand(1);
  mdhcal::offline::add_simulate(app);
  mdhcal::offline::add_convert(app);
  CLI11_PARSE(app, argc, argv);
  return 0;
}
