// SPDX-License-Identifier: MIT
// Frames and tools that stand beside a program: "TOOL_DATA[1]={X 1,Y 2,...}" (KRL), "UTOOL 1 X 1 Y 2 ... R 6", "USER 1: X 1 ... Rz 6",
// "pulses per degree: 1435.4, ...". Lines that begin with none of these words are passed over.
#include <array>

#include "offline/filter/target_text.hpp"
#include "offline/import/scanner.hpp"

namespace mdhcal::offline {

namespace {

// Six numbers, each behind a name or not, up to the end of the line.
std::vector<double> six_numbers(Scanner& s, const std::string& what) {
  const std::size_t begin = s.at();
  std::vector<double> numbers;
  while (!s.done() && s.peek() != '\n' && s.peek() != ';' && numbers.size() < 6) {
    if (s.at_number()) {
      numbers.push_back(s.number().value);
    } else if (s.name().empty()) {
      s.next();
    }
  }
  if (numbers.size() != 6) s.fail_at(begin, "Found " + std::to_string(numbers.size()) + " numbers for " + what + "; expected six: x, y, z and three angles.");
  return numbers;
}

}  // namespace

ProgramFrames read_frames(std::string_view text, ProgramLanguage language, const std::string& path) {
  if (language == ProgramLanguage::rapid) return rapid_frames(text, path);
  constexpr std::array<std::string_view, 3> tools{"utool", "tool_data", "tool"}, frames{"uframe", "base_data", "user"};
  ProgramFrames out;
  Scanner s(text, path);
  while (!s.done()) {
    s.skip_spaces();
    if (s.take("pulses per degree:")) {
      while (!s.done() && s.peek() != '\n') {
        s.skip_spaces();
        if (!s.at_number()) break;
        out.pulses_per_degree.push_back(s.number().value);
        if (!(out.pulses_per_degree.back() > 0 || out.pulses_per_degree.back() < 0)) s.fail("Found no pulses per degree; expected a number other than zero.");
        s.skip_spaces();
        if (s.peek() == ',') s.next();
      }
      s.skip_line();
      continue;
    }
    const std::string word = small_letters(s.name());
    for (std::size_t k = 0; k < tools.size(); ++k) {
      if (word != tools[k] && word != frames[k]) continue;
      s.skip_spaces();
      if (s.peek() == '[') s.next();
      if (!s.at_number()) break;
      const std::string number = number_name(s.number());
      (word == tools[k] ? out.tools : out.frames)[number] = frame_from(language, six_numbers(s, word + ' ' + number));
      break;
    }
    s.skip_line();
  }
  return out;
}

}  // namespace mdhcal::offline
