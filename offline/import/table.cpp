// SPDX-License-Identifier: MIT
#include "offline/import/table.hpp"

#include <algorithm>
#include <map>

#include "offline/base/error.hpp"
#include "offline/import/meaning.hpp"
#include "offline/import/numbers.hpp"

namespace mdhcal::offline {

namespace {

// Enough to tell a layout by, and few enough that a long file is not parted four times.
constexpr std::size_t lines_looked_at = 400;

struct TextLine {
  std::string_view text;
  long number = 0;
};

bool blank_line(std::string_view line) { return line.find_first_not_of(" \t,;") == std::string_view::npos; }

bool comment_line(std::string_view line) {
  const std::size_t start = line.find_first_not_of(" \t");
  return start != std::string_view::npos && (line[start] == '#' || line[start] == '%' || line.substr(start).starts_with("//"));
}

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

// The fields of a line. False where a quote is not closed or text stands behind one: `bad` is then its place.
bool part(std::string_view line, char delimiter, std::vector<TableField>& fields, std::size_t& bad) {
  fields.clear();
  std::size_t at = 0;
  const bool blanks = delimiter == ' ';
  const auto parts = [&](char c) { return blanks ? c == ' ' || c == '\t' : c == delimiter; };
  while (true) {
    while (at < line.size() && (line[at] == ' ' || (blanks && line[at] == '\t'))) ++at;
    if (blanks && at == line.size()) break;
    const std::size_t start = at;
    TableField field{"", static_cast<long>(at) + 1};
    if (at < line.size() && line[at] == '"') {
      for (++at; at < line.size(); ++at) {
        if (line[at] == '"') {
          if (at + 1 == line.size() || line[at + 1] != '"') break;
          ++at;
        }
        field.text += line[at];
      }
      if (at == line.size()) {
        bad = start;
        return false;
      }
      ++at;
      while (at < line.size() && !parts(line[at])) {
        if (line[at] != ' ') {
          bad = at;
          return false;
        }
        ++at;
      }
      field.text = without_blanks(field.text);
    } else {
      while (at < line.size() && !parts(line[at])) ++at;
      field.text = without_blanks(line.substr(start, at - start));
    }
    fields.push_back(std::move(field));
    if (at >= line.size()) break;
    ++at;
  }
  return true;
}

std::size_t numbers_in(const std::vector<TableField>& fields) {
  return static_cast<std::size_t>(std::count_if(fields.begin(), fields.end(), [](const TableField& f) { return may_be_number(f.text); }));
}

// The commonest count of fields among lines with numbers (the larger of two that are as common), and how many numbers
// lines of that count hold.
struct Parted {
  std::size_t fields = 0, numbers = 0, most_numbers = 0;
};

Parted parted(const std::vector<TextLine>& lines, char delimiter) {
  std::map<std::size_t, Parted> by_count;
  std::map<std::size_t, std::size_t> lines_of_count;
  std::vector<TableField> fields;
  std::size_t bad = 0;
  for (std::size_t k = 0; k < lines.size() && k < lines_looked_at; ++k) {
    if (!part(lines[k].text, delimiter, fields, bad)) continue;
    const std::size_t numbers = numbers_in(fields);
    if (numbers == 0) continue;
    Parted& entry = by_count[fields.size()];
    entry.fields = fields.size();
    entry.numbers += numbers;
    entry.most_numbers = std::max(entry.most_numbers, numbers);
    ++lines_of_count[fields.size()];
  }
  Parted best;
  std::size_t most_lines = 0;
  for (const auto& [count, entry] : by_count) {
    if (lines_of_count[count] >= most_lines) {
      most_lines = lines_of_count[count];
      best = entry;
    }
  }
  return best;
}

char told_delimiter(const std::vector<TextLine>& lines, Parted& best) {
  char told = ',';
  for (const char delimiter : {'\t', ';', ','}) {
    const Parted entry = parted(lines, delimiter);
    if (entry.numbers > best.numbers) {
      best = entry;
      told = delimiter;
    }
  }
  // A point has three numbers. Blanks part a line only where nothing else parts it so: they also stand in names.
  if (best.most_numbers >= 3) return told;
  const Parted entry = parted(lines, ' ');
  if (entry.numbers > best.numbers) {
    best = entry;
    told = ' ';
  }
  return told;
}

// A line that heads a table rather than a row in which nothing was measured.
bool is_missing_row(const std::vector<TableField>& fields) {
  bool marked = false;
  for (std::size_t k = 1; k < fields.size(); ++k) {
    if (!is_missing_mark(fields[k].text)) return false;
    marked = marked || !fields[k].text.empty();
  }
  return marked;
}

bool is_unit_row(const std::vector<TableField>& fields) {
  return std::all_of(fields.begin(), fields.end(), [](const TableField& f) { return f.text.empty() || unit_of_word(f.text) != nullptr; });
}

// The names of the columns from the lines above the first row. A cell that names several columns stands above the first of
// them: the empty ones to its right are taken with it, but not in the last line.
std::vector<std::string> header_of(const std::vector<std::vector<TableField>>& above, std::size_t columns) {
  std::vector<std::string> header(above.empty() ? 0 : columns);
  std::size_t last = above.size();
  while (last > 1 && is_unit_row(above[last - 1])) --last;
  for (std::size_t line = 0; line < above.size(); ++line) {
    const bool units = line >= last;
    std::string cell;
    for (std::size_t k = 0; k < columns; ++k) {
      const std::string& here = above[line][k].text;
      cell = here.empty() && line + 1 < last ? cell : here;
      if (cell.empty()) continue;
      if (!header[k].empty()) header[k] += ' ';
      header[k] += units ? '[' + cell + ']' : cell;
    }
  }
  return header;
}

// The decimal separator that fields show which can be read with one of the two only.
char told_decimal(const TextTable& table) {
  const TableField* shown[2] = {nullptr, nullptr};
  long shown_line[2] = {0, 0};
  bool commas = false;
  const TableField* first_comma = nullptr;
  long comma_line = 0;
  for (const TableRow& row : table.rows) {
    for (const TableField& field : row.fields) {
      const bool point = parse_number(field.text, '.').has_value(), comma = parse_number(field.text, ',').has_value();
      if (point != comma) {
        const std::size_t which = comma ? 1 : 0;
        if (shown[which] == nullptr) {
          shown[which] = &field;
          shown_line[which] = row.line;
        }
      }
      if (point && comma && field.text.find(',') != std::string::npos) {
        if (!commas) {
          first_comma = &field;
          comma_line = row.line;
        }
        commas = true;
      }
    }
  }
  if (shown[0] != nullptr && shown[1] != nullptr) {
    throw InputError(table.path, shown_line[1], shown[1]->column,
                     "Found \"" + shown[1]->text + "\" with a decimal comma, and \"" + shown[0]->text + "\" in line " +
                         std::to_string(shown_line[0]) + " with a decimal point; expected one of them (key \"decimal\" of a profile).");
  }
  if (shown[1] != nullptr) return ',';
  if (shown[0] == nullptr && commas) {
    throw InputError(table.path, comma_line, first_comma->column,
                     "Found \"" + first_comma->text + "\", and nothing in the file tells whether its comma parts thousands or "
                     "decimals; expected --decimal . or --decimal , to say which.");
  }
  return '.';
}

}  // namespace

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find_first_of("\r\n", at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + (text.substr(end, 2) == "\r\n" ? 2 : 1);
  }
  return lines;
}

std::string first_lines(std::string_view text, std::size_t count) {
  std::string shown;
  for (const std::string_view line : lines_of(text)) {
    if (count-- == 0) break;
    shown += "\n  | ";
    for (const char c : line.substr(0, 100)) shown += static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? ' ' : c;
    if (line.size() > 100) shown += "...";
  }
  return shown;
}

bool is_missing_mark(std::string_view field) {
  if (field.find_first_not_of("-?.*/ ") == std::string_view::npos) return true;
  std::string word;
  for (const char c : field) {
    if (c != ' ' && c != '_') word += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  for (const std::string_view mark : {"nan", "-nan", "n/a", "na", "#n/a", "missing", "null", "none", "notmeasured", "invalid", "lost",
                                      "occluded", "inf", "-inf", "1.#qnan", "-1.#ind", "nichtgemessen", "fehlt"}) {
    if (word == mark) return true;
  }
  return false;
}

TextTable read_text_table(const std::string& text, const std::string& path, const Profile& profile) {
  std::vector<TextLine> lines;
  std::string_view last_comment;  // above the first line: some programs put the header behind a comment's mark
  long number = 0;
  for (const std::string_view line : lines_of(text)) {
    ++number;
    if (static_cast<std::size_t>(number) <= profile.skip_lines || blank_line(line)) continue;
    if (comment_line(line)) {
      if (lines.empty()) last_comment = line.substr(std::min(line.find_first_not_of(" \t#/%"), line.size()));
      continue;
    }
    lines.push_back({line, number});
  }
  TextTable table;
  table.path = path;
  Parted layout;
  if (profile.delimiter != 0) {
    table.delimiter = profile.delimiter;
    layout = parted(lines, table.delimiter);
  } else {
    table.delimiter = told_delimiter(lines, layout);
  }
  if (layout.numbers == 0) {
    throw InputError(path, 1, 1, "Found no table of numbers; expected a tracker's export or a log of joints. Its first lines:" + first_lines(text, 5));
  }
  std::vector<TableField> fields;
  std::size_t first = lines.size();
  std::vector<std::vector<TableField>> above;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    std::size_t bad = 0;
    if (!part(lines[k].text, table.delimiter, fields, bad)) {
      if (first == lines.size()) continue;
      throw InputError(path, lines[k].number, static_cast<long>(bad) + 1, "Found a quote that is not closed, or text behind one; expected a field.");
    }
    if (fields.size() > layout.fields) {
      while (fields.size() > layout.fields && fields.back().text.empty()) fields.pop_back();
    }
    const bool row_before = first < lines.size();
    const bool is_row = row_before || (fields.size() == layout.fields && 2 * numbers_in(fields) >= layout.most_numbers) ||
                        (fields.size() == layout.fields && !above.empty() && is_missing_row(fields));
    if (!is_row) {
      if (fields.size() == layout.fields) {
        above.push_back(fields);
      } else {
        above.clear();
      }
      continue;
    }
    if (!row_before) first = k;
    if (fields.size() != layout.fields) {
      throw InputError(path, lines[k].number, 1,
                       "Found " + std::to_string(fields.size()) + " fields; expected " + std::to_string(layout.fields) + " as in the other rows.");
    }
    table.rows.push_back({fields, lines[k].number});
  }
  if (table.rows.empty()) throw InputError(path, 1, 1, "Found no row of numbers; expected a table. Its first lines:" + first_lines(text, 5));
  if (profile.columns.empty()) {
    std::size_t bad = 0;
    if (above.empty() && first == 0 && part(last_comment, table.delimiter, fields, bad) && fields.size() == layout.fields && numbers_in(fields) == 0) {
      above.push_back(fields);
      table.header_in_comment = true;
    }
    table.header = header_of(above, layout.fields);
  }
  table.decimal = profile.decimal != 0 ? profile.decimal : told_decimal(table);
  return table;
}

}  // namespace mdhcal::offline
