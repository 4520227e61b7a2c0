// SPDX-License-Identifier: MIT
#include <filesystem>
#include <set>

#include "offline/base/error.hpp"
#include "offline/base/read_file.hpp"
#include "offline/batch/batch.hpp"
#include "offline/measure/columns.hpp"

namespace mdhcal::offline {

namespace {

// A name that is one folder, visible, on every file system.
bool plain_name(std::string_view name) {
  constexpr std::string_view allowed =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_.+ ";
  return !name.empty() && name.size() <= 100 && name[0] != '.' && name.find_first_not_of(allowed) == std::string_view::npos;
}

}  // namespace

std::vector<BatchEntry> read_manifest(const std::string& path) {
  const std::string text = read_file(path, "a manifest");
  Csv csv(text, path, "a manifest");
  Columns columns(csv);
  const Column name = columns.require("name", plain_number, "with a folder's name for each robot");
  const Column robot = columns.require("robot", plain_number, "with each robot's file");
  const Column measurements = columns.require("measurements", plain_number, "with each robot's measurement file");
  const Column test = columns.find_text("test");
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const auto located = [&](const Column& column) {
    const std::string_view field = csv.field(column.index);
    if (field.empty()) csv.fail(column.index, "Found nothing; expected a file's name.");
    return (folder / field).string();
  };
  std::vector<BatchEntry> entries;
  std::set<std::string, std::less<>> names;
  while (csv.next()) {
    const std::string_view word = csv.field(name.index);
    if (!plain_name(word)) {
      csv.fail(name.index, "Found \"" + std::string(word) +
                               "\"; expected a folder's name of letters, digits, spaces and -_.+ that starts with no dot.");
    }
    if (!names.emplace(word).second) csv.fail(name.index, "Found \"" + std::string(word) + "\" again; expected each name once.");
    BatchEntry entry;
    entry.name = word;
    entry.robot = located(robot);
    entry.measurements = located(measurements);
    if (test && !test.empty(csv)) entry.test = located(test);
    entries.push_back(std::move(entry));
  }
  if (entries.empty()) throw InputError(path, 0, 0, "The manifest has no rows; expected one for each robot.");
  return entries;
}

std::vector<BatchEntry> slice_of(const std::vector<BatchEntry>& entries, std::size_t slice, std::size_t slices) {
  std::vector<BatchEntry> out;
  for (std::size_t i = slice - 1; i < entries.size(); i += slices) out.push_back(entries[i]);
  return out;
}

}  // namespace mdhcal::offline
