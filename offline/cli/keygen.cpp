// SPDX-License-Identifier: MIT
#include <filesystem>
#include <memory>

#include "offline/base/error.hpp"
#include "offline/base/folder.hpp"
#include "offline/cli/commands.hpp"
#include "offline/cli/messages.hpp"
#include "offline/output/sign.hpp"

namespace mdhcal::offline {

namespace {

struct KeygenArguments {
  std::string output, from;
};

void refuse_taken(const std::string& path, const std::string& way_on) {
  std::error_code ignored;
  if (!std::filesystem::exists(std::filesystem::symlink_status(path, ignored))) return;
  throw InputError(path, 0, 0, "The key is already there; expected a name that is not taken" + way_on + '.');
}

void run_keygen(const KeygenArguments& arguments) {
  const std::string secret_path = arguments.output + ".key";
  const std::string public_path = arguments.output + ".pub";
  refuse_taken(public_path, "");
  KeyPair key;
  if (arguments.from.empty()) {
    // A run that was stopped half way leaves the secret key alone.
    refuse_taken(secret_path, ", or --from " + secret_path + " for its public key");
    key = generate_key();
    write_new_file(secret_path, key_text(key.secret), Access::owner);
  } else {
    key = key_of(read_secret_key(arguments.from).seed);
  }
  write_new_file(public_path, key_text(key.public_key), Access::all);
}

}  // namespace

void add_keygen(CLI::App& app) {
  auto arguments = std::make_shared<KeygenArguments>();
  CLI::App* command = app.add_subcommand("keygen", "Make an Ed25519 key pair that signs blobs: NAME.key and NAME.pub");
  command->add_option("-o,--output", arguments->output, "NAME of the two files")->required();
  command->add_option("--from", arguments->from, "A secret key that is there: write its public key NAME.pub only");
  command->footer("Examples: mdhcal keygen -o metrology\n"
                  "          mdhcal keygen --from metrology.key -o metrology");
  command->callback([arguments] { run_keygen(*arguments); });
}

}  // namespace mdhcal::offline
