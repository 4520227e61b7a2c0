// SPDX-License-Identifier: MIT
#include <charconv>
#include <memory>
#include <optional>
#include <vector>

#include "mdhcal/slot.hpp"
#include "offline/base/error.hpp"
#include "offline/base/folder.hpp"
#include "offline/cli/blob_command.hpp"
#include "offline/cli/commands.hpp"
#include "offline/output/blob_file.hpp"
#include "offline/output/export.hpp"

namespace mdhcal::offline {

namespace {

struct ExportArguments {
  std::string blob, output, format, address, symbol = "mdhcal_blob";
  bool slot = false;
  std::uint32_t sequence = 1;
};

std::uint64_t address_of(const ExportArguments& arguments) {
  const std::string& text = arguments.address;
  if (text.empty()) {
    if (arguments.format == "hex" || arguments.format == "srec") {
      throw InputError("The format " + arguments.format + " states an address, expected --address A.");
    }
    return 0;
  }
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  const char* first = text.data() + (hexadecimal ? 2 : 0);
  const char* end = text.data() + text.size();
  std::uint64_t address = 0;
  const auto [stop, error] = std::from_chars(first, end, address, hexadecimal ? 16 : 10);
  if (error != std::errc{} || stop != end) {
    throw InputError("--address is '" + text + "', expected a number such as 0x08040000 or 134479872.");
  }
  if (address % slot_header_size != 0) {
    throw InputError("--address is " + text + ", expected a multiple of 32, the flash granule.");
  }
  return address;
}

std::vector<std::uint8_t> image_of(const ExportArguments& arguments) {
  const BlobFile file = read_blob_file(arguments.blob);
  require_loadable(file, arguments.blob);
  warn_of_acceptance(file);
  const Blob& blob = file.bytes;
  std::vector<std::uint8_t> image;
  if (arguments.slot) {
    std::uint32_t crc = 0;
    for (std::size_t k = 4; k > 0; --k) crc = crc << 8U | blob.at(blob_layout::crc + k - 1);
    image.resize(slot_header_size);
    encode_slot_header({arguments.sequence, crc}, image.data());
  }
  image.insert(image.end(), blob.begin(), blob.end());
  return image;
}

void run_export(const ExportArguments& arguments) {
  const std::uint64_t address = address_of(arguments);
  const std::vector<std::uint8_t> image = image_of(arguments);
  std::string text;
  if (arguments.format == "bin") text.assign(image.begin(), image.end());
  if (arguments.format == "hex") text = intel_hex(image, address);
  if (arguments.format == "srec") text = s_record(image, address);
  if (arguments.format == "c") text = c_array(image, arguments.symbol);
  write_file(arguments.output, text);
}

}  // namespace

void add_export(CLI::App& app) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = app.add_subcommand("export", "Write a blob as an image for a flash programmer or a compiler");
  command->add_option("BLOB", arguments->blob, "Parameter blob")->required();
  command->add_option("--format", arguments->format, "bin, hex (Intel HEX), srec (S-record) or c (array for C and C++)")
      ->required()
      ->check(CLI::IsMember({"bin", "hex", "srec", "c"}));
  command->add_option("--address", arguments->address, "Address in flash, 0x... or decimal; bin and c do not state it");
  command->add_option("-o,--output", arguments->output, "File to write")->required();
  CLI::Option* slot = command->add_flag("--slot", arguments->slot, "Put the slot header of the store before the blob");
  command->add_option("--sequence", arguments->sequence, "Sequence in the slot header")->needs(slot)->capture_default_str();
  command->add_option("--symbol", arguments->symbol, "Name of the array in C")->capture_default_str();
  command->footer("Example:\n  mdhcal export calibration.blob --format hex --address 0x08040000 --slot --sequence 1 -o slot.hex");
  command->callback([arguments] { run_export(*arguments); });
}

}  // namespace mdhcal::offline
