// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>

int main(int argc, char** argv) {
  CLI::App app{"mdhcal: calibrate an arm on the host, correct it in the controller"};
  app.require_subcommand(1);
  CLI11_PARSE(app, argc, argv);
  return 0;
}
