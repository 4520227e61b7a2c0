// SPDX-License-Identifier: MIT
#include "offline/filter/number_text.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>

namespace mdhcal::offline {

namespace {

std::string_view written(std::string_view text, const ProgramNumber& number) { return text.substr(number.begin, number.end - number.begin); }

// 0.001 mm; 1e-6 rad and 1e-6 of a quaternion turn a metre by a micrometre, and so nearly does 1e-4 deg.
int least_decimals(ProgramLanguage language, ProgramPositionKind kind, bool length) {
  switch (language) {
    case ProgramLanguage::urscript: return 6;
    case ProgramLanguage::rapid: return kind == ProgramPositionKind::joints ? 4 : length ? 3 : 6;
    case ProgramLanguage::krl: case ProgramLanguage::val3: return kind == ProgramPositionKind::joints ? 4 : length ? 3 : 4;
    default: return 0;  // fixed by the controller
  }
}

std::vector<int> decimals_for(std::string_view text, ProgramLanguage language, const ProgramTarget& target, std::size_t count) {
  const ProgramPosition& position = target.position;
  std::vector<int> out(count, 0);
  if (position.kind == ProgramPositionKind::pulses) return out;
  const std::size_t lengths = position.kind == ProgramPositionKind::pose ? 3 : 0;
  int most[2] = {least_decimals(language, position.kind, true), least_decimals(language, position.kind, false)};
  for (std::size_t k = 0; k < count; ++k) {
    int& group = most[k < lengths ? 0 : 1];
    group = std::max(group, decimals_of(written(text, position.numbers[k])));
  }
  for (std::size_t k = 0; k < count; ++k) out[k] = most[k < lengths ? 0 : 1];
  return out;
}

constexpr const char* val3_names[2][6] = {{"x", "y", "z", "rx", "ry", "rz"}, {"j1", "j2", "j3", "j4", "j5", "j6"}};

}  // namespace

int decimals_of(std::string_view number) {
  const std::size_t e = std::min(number.find_first_of("eE"), number.size());
  const std::size_t point = number.substr(0, e).find('.');
  int decimals = point == std::string_view::npos ? 0 : static_cast<int>(std::min<std::size_t>(e - point - 1, 15));
  if (e < number.size()) {
    int exponent = 0;
    const char* first = number.data() + e + 1;
    if (first < number.data() + number.size() && *first == '+') ++first;
    (void)std::from_chars(first, number.data() + number.size(), exponent);
    decimals -= std::clamp(exponent, -15, 15);
  }
  return std::clamp(decimals, 0, 15);
}

std::string with_decimals(double value, int decimals) {
  char buffer[400];  // the largest double has 309 digits before the point
  const int size = std::snprintf(buffer, sizeof buffer, "%.*f", decimals, value);
  std::string text(buffer, static_cast<std::size_t>(std::clamp<int>(size, 0, sizeof buffer - 1)));
  if (text.find_first_not_of("-0.") == std::string::npos && text.starts_with("-")) text.erase(0, 1);
  return text;
}

std::vector<Edit> number_edits(std::string_view text, ProgramLanguage language, const ProgramTarget& target, const std::vector<double>& values) {
  std::vector<Edit> edits;
  const std::vector<int> decimals = decimals_for(text, language, target, values.size());
  const ProgramPosition& position = target.position;
  std::size_t behind = position.begin + std::string_view("<Value").size();
  for (std::size_t k = 0; k < values.size(); ++k) {
    const ProgramNumber& number = position.numbers[k];
    std::string now = with_decimals(values[k], decimals[k]);
    if (number.end == 0) {
      if (now.find_first_not_of("-0.") == std::string::npos) continue;
      edits.push_back({behind, behind, std::string(" ") + val3_names[position.kind == ProgramPositionKind::joints][k] + "=\"" + now + '"'});
      continue;
    }
    if (language == ProgramLanguage::val3) behind = number.end + 1;
    std::size_t begin = number.begin;
    if (language == ProgramLanguage::fanuc_ls) {
      // Right-aligned: a longer number takes blanks that stand before it, but for one.
      const std::size_t before = number.end - number.begin;
      while (now.size() > before + (number.begin - begin) && begin >= 2 && text[begin - 1] == ' ' && text[begin - 2] == ' ') --begin;
      const std::size_t width = number.end - begin;
      if (now.size() < width) now.insert(0, width - now.size(), ' ');
    }
    edits.push_back({begin, number.end, now});
  }
  return edits;
}

std::vector<double> rounded(std::string_view text, ProgramLanguage language, const ProgramTarget& target, const std::vector<double>& values) {
  const std::vector<int> decimals = decimals_for(text, language, target, values.size());
  std::vector<double> out = values;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const std::string now = with_decimals(values[k], decimals[k]);
    (void)std::from_chars(now.data(), now.data() + now.size(), out[k]);
  }
  return out;
}

}  // namespace mdhcal::offline
