// SPDX-License-Identifier: MIT
#include <memory>
#include <optional>

#include "offline/base/folder.hpp"
#include "offline/cli/blob_command.hpp"
#include "offline/cli/commands.hpp"
#include "offline/cli/messages.hpp"
#include "offline/output/blob_file.hpp"
#include "offline/output/sign.hpp"

namespace mdhcal::offline {

namespace {

struct SignArguments {
  std::string blob, key, output;
  std::optional<std::uint32_t> counter;
};

void run_sign(const SignArguments& arguments) {
  const BlobFile file = read_blob_file(arguments.blob);
  require_loadable(file, arguments.blob);
  warn_of_acceptance(file);
  const SecretKey key = read_secret_key(arguments.key);
  if (key.open_to_others) {
    warn(arguments.key + ": others than its owner may read this secret key, and can sign with it; chmod 600 " + arguments.key);
  }
  if (arguments.counter && *arguments.counter < file.model.security_counter) {
    warn("The security counter goes down, from " + std::to_string(file.model.security_counter) + " to " +
         std::to_string(*arguments.counter) + ": controllers that ask for the higher one refuse the signed blob.");
  }
  Blob blob = file.bytes;
  sign(blob, key_of(key.seed), arguments.counter);
  write_file(arguments.output, {reinterpret_cast<const char*>(blob.data()), blob.size()});
}

}  // namespace

void add_sign(CLI::App& app) {
  auto arguments = std::make_shared<SignArguments>();
  CLI::App* command = app.add_subcommand("sign", "Sign a blob with Ed25519");
  command->add_option("BLOB", arguments->blob, "Parameter blob, signed or not")->required();
  command->add_option("--key", arguments->key, "Secret key, NAME.key of mdhcal keygen")->required();
  command->add_option("--counter", arguments->counter, "Security counter to sign in; default: the blob's own");
  command->add_option("-o,--output", arguments->output, "Signed blob to write")->required();
  command->footer("Example:\n  mdhcal sign calibration.blob --key metrology.key --counter 3 -o signed.blob");
  command->callback([arguments] { run_sign(*arguments); });
}

}  // namespace mdhcal::offline
