// SPDX-License-Identifier: MIT
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "offline/base/error.hpp"
#include "offline/base/text.hpp"
#include "offline/cli/commands.hpp"
#include "offline/output/blob_describe.hpp"
#include "offline/output/sign.hpp"

namespace mdhcal::offline {

namespace {

struct ShowArguments {
  std::string blob, key;
  bool json = false;
};

void run_show(const ShowArguments& arguments) {
  const BlobFile file = read_blob_file(arguments.blob);
  const bool verifies = arguments.key.empty() || signature_verifies(file.bytes, read_public_key(arguments.key));
  const nlohmann::ordered_json blob = describe_json(file);
  // A name may be any bytes that the decoder accepts; JSON is UTF-8.
  const std::string text = arguments.json ? blob.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n'
                                          : printable(describe_text(blob));
  (void)std::fwrite(text.data(), 1, text.size(), stdout);
  if (!verifies) throw Refusal(arguments.blob + ": the signature does not verify under " + arguments.key + ".");
}

}  // namespace

void add_show(CLI::App& app) {
  auto arguments = std::make_shared<ShowArguments>();
  CLI::App* command = app.add_subcommand("show", "Print everything that is in a blob");
  command->add_option("BLOB", arguments->blob, "Parameter blob")->required();
  command->add_flag("--json", arguments->json, "JSON for programs");
  command->add_option("--key", arguments->key, "Public key that the signature must verify under; exit status 1 if not");
  command->footer("Example:\n  mdhcal show result/calibration.blob");
  command->callback([arguments] { run_show(*arguments); });
}

}  // namespace mdhcal::offline
