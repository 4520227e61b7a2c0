// SPDX-License-Identifier: MIT
// What the readers of robot programs share: a place in a text that only moves forward.
#pragma once

#include <string>
#include <string_view>

#include "offline/import/program.hpp"

namespace mdhcal::offline {

class Scanner {
 public:
  Scanner(std::string_view text, const std::string& path) : text_(text), path_(path) {}

  std::size_t at() const { return at_; }
  bool done() const { return at_ >= text_.size(); }
  char peek() const { return done() ? '\0' : text_[at_]; }
  char next() { return done() ? '\0' : text_[at_++]; }
  void go(std::size_t at) { at_ = at < text_.size() ? at : text_.size(); }
  std::string_view text() const { return text_; }

  /// Passes over blanks and the ends of lines.
  void skip_blanks();
  /// Passes over blanks, not over the ends of lines.
  void skip_spaces();
  void skip_line();
  /// Passes over the string that a quote starts here, to the end of the line at most.
  void skip_string();
  /// Whether the text here starts so, capital and small letters the same.
  bool looks_at(std::string_view word) const;
  /// looks_at(), and moves behind it.
  bool take(std::string_view word);
  /// A name of letters, digits, '_' and '$' here; empty if there is none.
  std::string_view name();
  /// A number here: sign, digits, point, exponent. Throws InputError if there is none.
  ProgramNumber number();
  /// Whether a number starts here.
  bool at_number() const;

  [[noreturn]] void fail(const std::string& message) const { fail_at(at_, message); }
  [[noreturn]] void fail_at(std::size_t at, const std::string& message) const;
  /// Throws if this is not the character here; moves behind it.
  void expect(char c);

 private:
  std::string_view text_;
  const std::string& path_;
  std::size_t at_ = 0;
};

std::vector<ProgramPosition> read_krl(std::string_view text, const std::string& path);
std::vector<ProgramPosition> read_rapid(std::string_view text, const std::string& path);
std::vector<ProgramPosition> read_fanuc_ls(std::string_view text, const std::string& path);
std::vector<ProgramPosition> read_inform(std::string_view text, const std::string& path);
std::vector<ProgramPosition> read_urscript(std::string_view text, const std::string& path);
std::vector<ProgramPosition> read_val3(std::string_view text, const std::string& path);
std::vector<ProgramPosition> read_joint_state(std::string_view text, const std::string& path);

}  // namespace mdhcal::offline
