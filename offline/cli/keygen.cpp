// SPDX-License-Identifier: MIT
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <memory>
#include <unistd.h>

#include "offline/base/error.hpp"
#include "offline/base/folder.hpp"
#include "offline/cli/commands.hpp"
#include "offline/output/sign.hpp"

namespace mdhcal::offline {

namespace {

// Readable by its owner only from the first moment, and never over an existing file: a lost key signs no more blobs.
void write_secret(const std::string& path, const std::string& text) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL, S_IRUSR | S_IWUSR);
  if (file < 0) {
    throw InputError(path, 0, 0, std::string("The secret key cannot be written (") + std::strerror(errno) +
                                     "), expected a name that is not taken.");
  }
  const bool written = write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (close(file) != 0 || !written) {
    unlink(path.c_str());
    throw InputError(path, 0, 0, "The secret key cannot be written.");
  }
}

void run_keygen(const std::string& output) {
  const std::string secret_path = output + ".key";
  const std::string public_path = output + ".pub";
  if (std::filesystem::exists(public_path)) {
    throw InputError(public_path, 0, 0, "The public key is already there, expected a name that is not taken.");
  }
  const KeyPair key = generate_key();
  write_secret(secret_path, key_text(key.secret));
  write_file(public_path, key_text(key.public_key));
}

}  // namespace

void add_keygen(CLI::App& app) {
  auto output = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("keygen", "Make an Ed25519 key pair that signs blobs: NAME.key and NAME.pub");
  command->add_option("-o,--output", *output, "NAME of the two files")->required();
  command->footer("Example:\n  mdhcal keygen -o metrology");
  command->callback([output] { run_keygen(*output); });
}

}  // namespace mdhcal::offline
