// SPDX-License-Identifier: MIT
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "offline/base/text.hpp"
#include "offline/cli/commands.hpp"
#include "offline/output/blob_describe.hpp"

namespace mdhcal::offline {

namespace {

struct DiffArguments {
  std::string a, b;
  bool json = false;
};

void run_diff(const DiffArguments& arguments) {
  const nlohmann::ordered_json difference =
      difference_json(read_blob_file(arguments.a).model, read_blob_file(arguments.b).model);
  const std::string text = arguments.json
                               ? difference.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n'
                               : printable(difference_text(difference));
  (void)std::fwrite(text.data(), 1, text.size(), stdout);
}

}  // namespace

void add_diff(CLI::App& app) {
  auto arguments = std::make_shared<DiffArguments>();
  CLI::App* command = app.add_subcommand("diff", "Print what changed between two calibrations of one robot");
  command->add_option("A", arguments->a, "Parameter blob, the earlier one")->required();
  command->add_option("B", arguments->b, "Parameter blob, the later one")->required();
  command->add_flag("--json", arguments->json, "JSON for programs");
  command->footer("Example:\n  mdhcal diff january/calibration.blob june/calibration.blob");
  command->callback([arguments] { run_diff(*arguments); });
}

}  // namespace mdhcal::offline
