// SPDX-License-Identifier: MIT
#include "offline/import/program.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "offline/base/error.hpp"
#include "offline/import/scanner.hpp"

namespace mdhcal::offline {

namespace {

char lowered(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

// Whether `word` stands in the text as a word of its own, capital and small letters the same.
bool has_word(std::string_view text, std::string_view word) {
  const auto letter = [](char c) { return (lowered(c) >= 'a' && lowered(c) <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  for (auto at = text.begin(); at != text.end();) {
    at = std::search(at, text.end(), word.begin(), word.end(), [](char a, char b) { return lowered(a) == lowered(b); });
    if (at == text.end()) return false;
    const auto end = at + static_cast<std::ptrdiff_t>(word.size());
    const bool own = (at == text.begin() || !letter(at[-1]) || !letter(word.front())) && (end == text.end() || !letter(*end) || !letter(word.back()));
    if (own) return true;
    ++at;
  }
  return false;
}

// Whether a line starts with the word.
bool has_line(std::string_view text, std::string_view word) {
  for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
    if (at == 0 || text[at - 1] == '\n' || text[at - 1] == '\r') return true;
  }
  return false;
}

}  // namespace

void Scanner::skip_blanks() {
  while (!done() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\r' || text_[at_] == '\n')) ++at_;
}

void Scanner::skip_spaces() {
  while (!done() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
}

void Scanner::skip_line() {
  at_ = std::min(text_.find('\n', at_), text_.size());
  if (at_ < text_.size()) ++at_;
}

void Scanner::skip_string() {
  const char quote = next();
  while (!done() && peek() != quote && peek() != '\n') ++at_;
  if (peek() == quote) ++at_;
}

bool Scanner::looks_at(std::string_view word) const {
  if (text_.size() - at_ < word.size()) return false;
  return std::equal(word.begin(), word.end(), text_.begin() + static_cast<std::ptrdiff_t>(at_), [](char a, char b) { return lowered(a) == lowered(b); });
}

bool Scanner::take(std::string_view word) {
  if (!looks_at(word)) return false;
  at_ += word.size();
  return true;
}

std::string_view Scanner::name() {
  const std::size_t start = at_;
  while (!done()) {
    const char c = text_[at_];
    const bool letter = (lowered(c) >= 'a' && lowered(c) <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '$' || static_cast<unsigned char>(c) >= 0x80U;
    if (!letter) break;
    ++at_;
  }
  return text_.substr(start, at_ - start);
}

bool Scanner::at_number() const {
  std::size_t k = at_;
  if (k < text_.size() && (text_[k] == '-' || text_[k] == '+')) ++k;
  if (k < text_.size() && text_[k] == '.') ++k;
  return k < text_.size() && text_[k] >= '0' && text_[k] <= '9';
}

ProgramNumber Scanner::number() {
  if (!at_number()) {
    const std::string_view here = text_.substr(at_, 20);
    fail("Found \"" + std::string(here.substr(0, here.find_first_of("\r\n"))) + "\"; expected a number.");
  }
  ProgramNumber out;
  out.begin = at_;
  const char* first = text_.data() + at_ + (text_[at_] == '+' ? 1 : 0);
  const auto parsed = std::from_chars(first, text_.data() + text_.size(), out.value);
  if (parsed.ec != std::errc() || !std::isfinite(out.value)) fail("Found a number that is too large or too small; expected a finite one.");
  at_ = static_cast<std::size_t>(parsed.ptr - text_.data());
  out.end = at_;
  return out;
}

void Scanner::fail_at(std::size_t at, const std::string& message) const {
  const std::size_t line_start = at == 0 ? 0 : text_.rfind('\n', at - 1) + 1;  // npos + 1 is 0
  throw InputError(path_, line_of(text_, at), 1 + static_cast<long>(at - line_start), message);
}

void Scanner::expect(char c) {
  if (peek() != c) fail(std::string("Expected '") + c + "' here.");
  ++at_;
}

std::optional<ProgramLanguage> program_language(std::string_view text) {
  if (has_word(text, "e6axis") || has_word(text, "e6pos") || (has_line(text, "DEFDAT") && has_word(text, "decl"))) return ProgramLanguage::krl;
  if (has_word(text, "jointtarget") || has_word(text, "robtarget")) return ProgramLanguage::rapid;
  if (has_line(text, "/PROG") && has_line(text, "/POS")) return ProgramLanguage::fanuc_ls;
  if (has_line(text, "/JOB") && has_line(text, "//POS")) return ProgramLanguage::inform;
  if (has_word(text, "jointrx") || (has_word(text, "<database") && has_word(text, "pointrx"))) return ProgramLanguage::val3;
  if (has_word(text, "movej") || has_word(text, "movel") || has_word(text, "set_tcp")) return ProgramLanguage::urscript;
  if (has_line(text, "position:") && has_line(text, "name:")) return ProgramLanguage::joint_state;
  return {};
}

std::string language_name(ProgramLanguage language) {
  switch (language) {
    case ProgramLanguage::krl: return "a KRL file";
    case ProgramLanguage::rapid: return "a RAPID module";
    case ProgramLanguage::fanuc_ls: return "a FANUC LS program";
    case ProgramLanguage::inform: return "a Yaskawa job (JBI)";
    case ProgramLanguage::urscript: return "a URScript program";
    case ProgramLanguage::val3: return "a VAL3 data file";
    case ProgramLanguage::joint_state: return "JointState messages (YAML)";
  }
  return "a program";
}

std::vector<ProgramPosition> read_program(std::string_view text, ProgramLanguage language, const std::string& path) {
  switch (language) {
    case ProgramLanguage::krl: return read_krl(text, path);
    case ProgramLanguage::rapid: return read_rapid(text, path);
    case ProgramLanguage::fanuc_ls: return read_fanuc_ls(text, path);
    case ProgramLanguage::inform: return read_inform(text, path);
    case ProgramLanguage::urscript: return read_urscript(text, path);
    case ProgramLanguage::val3: return read_val3(text, path);
    case ProgramLanguage::joint_state: return read_joint_state(text, path);
  }
  return {};
}

long line_of(std::string_view text, std::size_t at) {
  return 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(std::min(at, text.size())), '\n');
}

}  // namespace mdhcal::offline
