// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mdhcal::offline {

/// A table of comma, semicolon or tab separated values with a header, read row by row. UTF-8 with or without byte
/// order mark, LF or CRLF; blank lines, rows of nothing but separators and lines that start with `#` or `//` are skipped; fields
/// may be quoted ("" for a quote). With semicolons and tabs a number may have a decimal comma. Every error is an
/// InputError that names file, line and column (counted in bytes, from 1).
class Csv {
 public:
  /// `text` must outlive this object. `expected` names in messages what the file should be, "a measurement file".
  Csv(std::string_view text, std::string path, const std::string& expected);

  /// The header's names in lower case, a unit in brackets ("X [mm]") brought to the form "x_mm".
  const std::vector<std::string>& names() const { return names_; }

  /// Goes to the next row; false at the end of the file.
  bool next();

  /// Field `column` of the row, without the blanks around it.
  std::string_view field(std::size_t column) const { return fields_[column].text; }
  bool empty(std::size_t column) const { return fields_[column].text.empty(); }
  /// The field as a finite number; InputError if it is none.
  double number(std::size_t column) const;

  const std::string& path() const { return path_; }
  /// How far the text is read, in bytes.
  std::size_t position() const { return at_; }
  /// The line of the row, or of the header before the first next().
  long line() const { return line_; }
  /// The column of the line in which a field of the row begins.
  long column(std::size_t column) const { return column_at(fields_[column].at); }

  /// Throws InputError at a field of the row: "Column "q3": MESSAGE".
  [[noreturn]] void fail(std::size_t column, const std::string& message) const;
  /// Throws InputError at a column's name in the header.
  [[noreturn]] void fail_header(std::size_t column, const std::string& message) const;
  /// Throws InputError at the header's line.
  [[noreturn]] void fail_header(const std::string& message) const;

 private:
  struct Field {
    std::string_view text;
    std::size_t at = 0;       // byte of the file
    bool was_quoted = false;
  };

  void split();
  Field quoted_field();
  long column_at(std::size_t at) const;
  std::string name_of(std::size_t column) const;

  std::string_view text_;
  std::string path_;
  char separator_ = ',';
  std::size_t at_ = 0;
  std::size_t line_start_ = 0;
  long next_line_ = 1;
  long line_ = 0;
  long header_line_ = 0;
  std::vector<Field> fields_;
  std::vector<std::string> unquoted_;  // storage of this row's fields that held a doubled quote
  std::vector<std::string> names_;
  std::vector<std::string> header_;
  std::vector<long> header_columns_;
};

}  // namespace mdhcal::offline
