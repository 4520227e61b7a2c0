// SPDX-License-Identifier: MIT
#include "offline/import/profile.hpp"

#include <algorithm>
#include <filesystem>

#include "offline/embedded.hpp"
#include "offline/base/error.hpp"
#include "offline/import/meaning.hpp"
#include "offline/measure/rotations.hpp"
#include "offline/base/read_file.hpp"
#include "offline/robot/toml_text.hpp"

namespace mdhcal::offline {

namespace {

char small_letter(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

class ProfileReader {
 public:
  ProfileReader(const std::string& text, const std::string& path) : path_(path), root_(parse_toml(text, path)) {}

  Profile read(const std::string& name) {
    Profile p;
    p.name = name;
    for (auto&& [key, value] : root_) {
      const std::string_view word = key.str();
      if (word == "about") {
        p.about = text(value, word);
      } else if (word == "recognise") {
        p.recognise = texts(value, word);
      } else if (word == "encoding") {
        p.encoding = choice(value, word, {"utf-8", "utf-16", "latin-1"});
      } else if (word == "delimiter") {
        const std::string chosen = choice(value, word, {",", ";", "tab", "space"});
        p.delimiter = chosen == "tab" ? '\t' : chosen == "space" ? ' ' : chosen[0];
      } else if (word == "decimal") {
        p.decimal = choice(value, word, {".", ","})[0];
      } else if (word == "skip_lines") {
        p.skip_lines = static_cast<std::size_t>(number(value, word, 0, 1e6));
      } else if (word == "columns") {
        p.columns = texts(value, word);
        for (const std::string& column : p.columns) check_meaning(column, value);
      } else if (word == "rename") {
        read_rename(value, p);
      } else if (word == "names") {
        p.names = text(value, word);
        check_names(p.names, value);
      } else if (word == "rotation") {
        p.rotation = text(value, word);
        if (p.rotation != "none") (void)require_rotation_convention(p.rotation, path_ + ": rotation");
      } else if (word == "length_unit") {
        p.length_unit = choice(value, word, {"mm", "m", "um", "in"});
      } else if (word == "angle_unit") {
        p.angle_unit = choice(value, word, {"deg", "rad"});
      } else if (word == "joint_unit") {
        p.joint_unit = choice(value, word, {"deg", "rad"});
      } else if (word == "coverage") {
        p.coverage = number(value, word, 0.1, 10);
      } else if (word == "targets") {
        p.targets = texts(value, word);
      } else if (word == "joints") {
        p.joints = texts(value, word);
      } else {
        fail(key.source(), "Unknown key \"" + std::string(word) +
                               "\" in a profile; expected about, recognise, encoding, delimiter, decimal, skip_lines, columns, "
                               "rename, names, rotation, length_unit, angle_unit, joint_unit, coverage, targets or joints.");
      }
    }
    if (!p.columns.empty() && !p.rename.empty()) {
      fail(root_.get("rename")->source(), "Found [rename] beside \"columns\"; expected columns by position or by name.");
    }
    return p;
  }

 private:
  [[noreturn]] void fail(const toml::source_region& at, const std::string& message) const {
    throw InputError(path_, static_cast<long>(at.begin.line), static_cast<long>(at.begin.column), message);
  }

  std::string text(const toml::node& node, std::string_view key) const {
    if (!node.is_string() || node.as_string()->get().size() > 200) {
      fail(node.source(), "Key \"" + std::string(key) + "\": expected a text in quotes of at most 200 bytes.");
    }
    return node.as_string()->get();
  }

  std::vector<std::string> texts(const toml::node& node, std::string_view key) const {
    const toml::array* array = node.as_array();
    if (array == nullptr || array->empty() || array->size() > 1000) {
      fail(node.source(), "Key \"" + std::string(key) + "\": expected a list of texts, [\"...\", \"...\"].");
    }
    std::vector<std::string> out;
    for (const toml::node& each : *array) out.push_back(text(each, key));
    return out;
  }

  std::string choice(const toml::node& node, std::string_view key, std::initializer_list<std::string_view> terms) const {
    std::string expected;
    for (const std::string_view word : terms) {
      if (node.is_string() && node.as_string()->get() == word) return std::string(word);
      expected += (expected.empty() ? "\"" : " or \"") + std::string(word) + '"';
    }
    fail(node.source(), "Key \"" + std::string(key) + "\": expected " + expected + ".");
  }

  double number(const toml::node& node, std::string_view key, double low, double high) const {
    const double value = node.is_integer() ? static_cast<double>(node.as_integer()->get())
                         : node.is_floating_point() ? node.as_floating_point()->get() : low - 1;
    if (!(value >= low && value <= high)) fail(node.source(), "Key \"" + std::string(key) + "\": expected a number within its range.");
    return value;
  }

  void check_meaning(const std::string& word, const toml::node& at) const {
    if (!meaning_of_word(word)) {
      fail(at.source(), "Found the meaning \"" + word + "\" of a column; expected " + meaning_words() + ".");
    }
  }

  void read_rename(const toml::node& node, Profile& p) const {
    const toml::table* table = node.as_table();
    if (table == nullptr) fail(node.source(), "Key \"rename\": expected a section [rename].");
    for (auto&& [meaning, pattern] : *table) {
      check_meaning(std::string(meaning.str()), pattern);
      p.rename[std::string(meaning.str())] = text(pattern, meaning.str());
    }
  }

  void check_names(const std::string& pattern, const toml::node& at) const {
    if (!parts_of_name("", pattern, true)) {
      fail(at.source(), "Found the pattern \"" + pattern +
                            "\"; expected words in braces with text between them, such as \"{collection}::{id}::{target}\".");
    }
  }

  std::string path_;
  toml::table root_;
};

}  // namespace

Profile parse_profile(const std::string& text, const std::string& path, const std::string& name) {
  return ProfileReader(text, path).read(name);
}

std::vector<std::string> profile_names() {
  std::vector<std::string> names;
  for (const embedded::File& file : embedded::profiles()) names.emplace_back(file.name);
  return names;
}

Profile find_profile(const std::string& name) {
  std::error_code ignored;
  if (!std::filesystem::exists(name, ignored)) {
    for (const embedded::File& file : embedded::profiles()) {
      if (file.name == name) return parse_profile(std::string(file.text), name, name);
    }
    std::string names;
    for (const std::string& each : profile_names()) names += (names.empty() ? "" : ", ") + each;
    throw InputError("Found --profile " + name + ", which is no file and no built-in profile; expected one of: " + names + ".");
  }
  return parse_profile(read_file(name, "a profile (TOML)"), name, std::filesystem::path(name).stem().string());
}

std::optional<Profile> recognised_profile(const std::vector<std::string_view>& lines) {
  std::optional<Profile> best;
  for (const embedded::File& file : embedded::profiles()) {
    Profile profile = parse_profile(std::string(file.text), std::string(file.name), std::string(file.name));
    if (profile.recognise.empty() || (best && profile.recognise.size() <= best->recognise.size())) continue;
    const bool all = std::all_of(profile.recognise.begin(), profile.recognise.end(), [&](const std::string& pattern) {
      return std::any_of(lines.begin(), lines.end(), [&](std::string_view line) { return fits(line, pattern); });
    });
    if (all) best = std::move(profile);
  }
  return best;
}

bool fits(std::string_view text, std::string_view pattern) {
  // Greedy with one way back: the last '*' takes one character more.
  std::size_t t = 0, p = 0, star = std::string_view::npos, taken = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      taken = t;
    } else if (p < pattern.size() && small_letter(pattern[p]) == small_letter(text[t])) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++taken;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

}  // namespace mdhcal::offline
