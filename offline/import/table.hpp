// SPDX-License-Identifier: MIT
// A text as a table: where its fields are parted, which line heads it, which decimal separator it has.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "offline/import/profile.hpp"

namespace mdhcal::offline {

struct TableField {
  std::string text;
  long column = 0;       ///< of its line, in bytes from 1
};

struct TableRow {
  std::vector<TableField> fields;
  long line = 0;
};

struct TextTable {
  std::string path;
  char delimiter = ',';
  char decimal = '.';
  /// A name a column: the cells of the lines above the first row put together, a line of units in brackets. Empty
  /// without a header.
  std::vector<std::string> header;
  bool header_in_comment = false;  ///< the header stood behind a comment's mark, and may be a sentence of as many words
  std::vector<TableRow> rows;   ///< each with as many fields as the first

  std::size_t columns() const { return rows.empty() ? 0 : rows.front().fields.size(); }
};

/// The lines of a text, without their ends.
std::vector<std::string_view> lines_of(std::string_view text);

/// The first lines of a file, as a message shows them: at most `count`, each cut at 100 characters.
std::string first_lines(std::string_view text, std::size_t count);

/// Whether a field says that nothing was measured: empty, or one of the marks instruments write ("NaN", "---", "MISSING",
/// "not measured", ...).
bool is_missing_mark(std::string_view field);

/// Reads a table. What the profile does not state is told from the text: the delimiter is the one that parts it into the most
/// numbers; rows are the lines with the commonest count of fields from the first that holds numbers; lines of that count
/// above it are the header, else the last comment above it if that has as many words. Comments start with #, % or //. Throws InputError naming line and column: no
/// table, a row with another count of fields, numbers in both decimal notations, a quote that is not closed.
TextTable read_text_table(const std::string& text, const std::string& path, const Profile& profile);

}  // namespace mdhcal::offline
