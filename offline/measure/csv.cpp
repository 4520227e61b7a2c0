// SPDX-License-Identifier: MIT
#include "offline/measure/csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "offline/base/error.hpp"
#include "offline/base/text.hpp"

namespace mdhcal::offline {

namespace {

bool blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

// "X [mm]" and "x (mm)" as "x_mm".
std::string plain_name(std::string_view text) {
  std::string name;
  for (const char c : text) name += lower(c);
  const std::size_t open = name.find_first_of("[(");
  if (open != std::string::npos && open > 0 && (name.back() == ']' || name.back() == ')')) {
    const std::string unit(trimmed(std::string_view(name).substr(open + 1, name.size() - open - 2)));
    name = std::string(trimmed(std::string_view(name).substr(0, open))) + '_' + unit;
  }
  return name;
}

// "//" is what tracker software puts before the lines that describe its frame.
bool is_comment(std::string_view line) { return line.starts_with('#') || line.starts_with("//"); }

// The separator that the header uses outside quotes: tab before semicolon before comma.
char separator_of(std::string_view header) {
  bool quoted = false;
  char found = ',';
  for (const char c : header) {
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    if (c == '\t') return '\t';
    if (c == ';') found = ';';
  }
  return found;
}

std::string shown(std::string_view text) {
  return '"' + std::string(begin_of(text, 40)) + (text.size() > 40 ? "...\"" : "\"");
}

}  // namespace

Csv::Csv(std::string_view text, std::string path, const std::string& expected) : text_(text), path_(std::move(path)) {
  const std::size_t nul = text_.find('\0');
  if (nul != std::string_view::npos && !text_.starts_with("\xFF\xFE") && !text_.starts_with("\xFE\xFF")) {
    const long line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(nul), '\n');
    throw InputError(path_, line, 1, "Found a zero byte; expected " + expected + " (CSV text).");
  }
  require_text(text_, path_, expected);
  if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;
  line_start_ = at_;
  // The separator is only known once the header's line is.
  std::size_t start = at_;
  while (start < text_.size()) {
    const std::size_t end = std::min(text_.find('\n', start), text_.size());
    const std::string_view line = trimmed(text_.substr(start, end - start));
    if (!line.empty() && !is_comment(line)) {
      separator_ = separator_of(line);
      break;
    }
    start = end + 1;
  }
  if (!next()) throw InputError(path_, 1, 1, "Found an empty file; expected " + expected + " with a header line.");
  header_line_ = line_;
  // A separator at the end of the header names no column.
  while (fields_.size() > 1 && fields_.back().text.empty()) fields_.pop_back();
  // Where the line of each field begins is carried along: to look back from every field would be quadratic.
  std::size_t walked = line_start_, begin = line_start_;
  for (const Field& field : fields_) {
    for (; walked < field.at; ++walked) {
      if (text_[walked] == '\n') begin = walked + 1;
    }
    header_.emplace_back(field.text);
    header_columns_.push_back(static_cast<long>(field.at - begin) + 1);
    names_.push_back(plain_name(field.text));
  }
}

bool Csv::next() {
  while (at_ < text_.size()) {
    line_ = next_line_;
    line_start_ = at_;
    std::size_t first = at_;
    while (first < text_.size() && (text_[first] == ' ' || text_[first] == '\r')) ++first;
    if (is_comment(text_.substr(first, 2))) {
      const std::size_t end = text_.find('\n', first);
      at_ = end == std::string_view::npos ? text_.size() : end + 1;
      ++next_line_;
      continue;
    }
    split();
    if (std::all_of(fields_.begin(), fields_.end(), [](const Field& f) { return f.text.empty(); })) continue;
    if (names_.empty() || fields_.size() == names_.size()) return true;
    while (fields_.size() > names_.size() && fields_.back().text.empty()) fields_.pop_back();
    if (fields_.size() != names_.size()) {
      const std::size_t extra = std::min(fields_.size() - 1, names_.size());
      const bool commas = separator_ == ',' && fields_.size() > names_.size();
      throw InputError(path_, line_, column_at(fields_[extra].at),
                       "Found " + std::to_string(fields_.size()) + " fields; expected " +
                           std::to_string(names_.size()) + " as in the header" +
                           (commas ? " (decimal commas need semicolons or tabs between fields)." : "."));
    }
    return true;
  }
  return false;
}

// Splits the line at at_ into fields_ and moves behind its end.
void Csv::split() {
  fields_.clear();
  unquoted_.clear();
  while (true) {
    std::size_t start = at_;
    while (start < text_.size() && text_[start] == ' ') ++start;
    if (start < text_.size() && text_[start] == '"') {
      at_ = start;
      fields_.push_back(quoted_field());
    } else {
      std::size_t end = start;
      while (end < text_.size() && text_[end] != separator_ && text_[end] != '\n') ++end;
      fields_.push_back({trimmed(text_.substr(start, end - start)), start, false});
      at_ = end;
    }
    if (at_ >= text_.size()) break;
    if (text_[at_++] == '\n') {
      ++next_line_;
      break;
    }
  }
  if (at_ >= text_.size() && !text_.empty() && text_.back() != '\n') ++next_line_;
}

Csv::Field Csv::quoted_field() {
  const std::size_t open = at_;
  const long line = next_line_;
  const long column = column_at(open);
  bool doubled = false;
  std::size_t end = open + 1;
  for (; end < text_.size(); ++end) {
    if (text_[end] == '\n') ++next_line_;
    if (text_[end] != '"') continue;
    if (end + 1 < text_.size() && text_[end + 1] == '"') {
      doubled = true;
      ++end;
    } else {
      break;
    }
  }
  if (end >= text_.size()) {
    throw InputError(path_, line, column, "Found a quote that is never closed; expected another quote.");
  }
  Field field{text_.substr(open + 1, end - open - 1), open, true};
  at_ = end + 1;
  while (at_ < text_.size() && text_[at_] != separator_ && text_[at_] != '\n') {
    if (!blank(text_[at_])) {
      throw InputError(path_, next_line_, column_at(at_), "Found text behind a closing quote; expected a separator.");
    }
    ++at_;
  }
  if (doubled) {
    std::string text;
    for (std::size_t k = 0; k < field.text.size(); ++k) {
      text += field.text[k];
      if (field.text[k] == '"') ++k;
    }
    // A deque would keep addresses; fields with doubled quotes are rare enough to reserve once.
    if (unquoted_.capacity() == 0) unquoted_.reserve(4096);
    if (unquoted_.size() == unquoted_.capacity()) {
      throw InputError(path_, line, column, "Found a line of thousands of quoted fields; expected a table.");
    }
    unquoted_.push_back(std::move(text));
    field.text = unquoted_.back();
  }
  field.text = trimmed(field.text);
  return field;
}

double Csv::number(std::size_t column) const {
  const std::string_view text = fields_[column].text;
  if (text.empty()) fail(column, "found nothing; expected a number.");
  const char* first = text.data();
  const char* last = first + text.size();
  if (*first == '+' && text.size() > 1 && text[1] != '-') ++first;
  double value = 0;
  auto parsed = std::from_chars(first, last, value);
  std::array<char, 64> point{};
  if (parsed.ptr != last && separator_ != ',' && text.size() <= point.size() &&
      std::count(first, last, ',') == 1 && std::find(first, last, '.') == last) {
    char* end = std::replace_copy(first, last, point.data(), ',', '.');
    parsed = std::from_chars(point.data(), end, value);
    if (parsed.ptr == end) parsed.ptr = last;
  }
  if (parsed.ptr != last || parsed.ec == std::errc::invalid_argument) {
    fail(column, "found " + shown(text) + "; expected a number.");
  }
  if (parsed.ec != std::errc{} || !std::isfinite(value)) {
    fail(column, "found " + shown(text) + "; expected a finite number.");
  }
  return value;
}

long Csv::column_at(std::size_t at) const {
  // A quoted field may have begun on an earlier line than the one looked at.
  std::size_t start = at == 0 ? std::string_view::npos : text_.rfind('\n', at - 1);
  start = start == std::string_view::npos ? (text_.starts_with("\xEF\xBB\xBF") ? 3 : 0) : start + 1;
  return static_cast<long>(at - start) + 1;
}

std::string Csv::name_of(std::size_t column) const { return "Column \"" + header_[column] + "\": "; }

void Csv::fail(std::size_t column, const std::string& message) const {
  throw InputError(path_, line_, column_at(fields_[column].at), name_of(column) + message);
}

void Csv::fail_header(std::size_t column, const std::string& message) const {
  throw InputError(path_, header_line_, header_columns_[column], name_of(column) + message);
}

void Csv::fail_header(const std::string& message) const { throw InputError(path_, header_line_, 1, message); }

}  // namespace mdhcal::offline
