// SPDX-License-Identifier: MIT
// sensor_msgs/JointState as `ros2 topic echo` prints it: a YAML document a message, "---" between. Only this form is read:
// name and position as lists, in lines of "- item" or in brackets.
#include "offline/import/scanner.hpp"

namespace mdhcal::offline {

namespace {

std::string item(Scanner& s) {
  s.skip_spaces();
  std::string text;
  const char quote = s.peek();
  if (quote == '\'' || quote == '"') {
    s.next();
    while (!s.done() && s.peek() != quote && s.peek() != '\n') text += s.next();
    if (s.peek() == quote) s.next();
    return text;
  }
  while (!s.done() && s.peek() != ',' && s.peek() != ']' && s.peek() != '\n' && s.peek() != '\r' && s.peek() != '#') text += s.next();
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

// Calls `read` at each item of the list behind "key:".
template <class Read>
void list_items(Scanner& s, Read read) {
  s.skip_spaces();
  if (s.peek() == '[') {
    s.next();
    while (!s.done()) {
      s.skip_blanks();
      if (s.peek() == ']') break;
      read();
      s.skip_blanks();
      if (s.peek() == ',') {
        s.next();
      } else if (s.peek() != ']') {
        s.fail("Expected ',' or ']' in a list.");
      }
    }
    s.skip_line();
    return;
  }
  s.skip_line();
  while (!s.done()) {
    const std::size_t start = s.at();
    s.skip_spaces();
    const bool more = s.peek() == '-' && !s.looks_at("---");
    if (!more) {
      s.go(start);
      return;
    }
    s.next();
    s.skip_spaces();
    read();
    s.skip_line();
  }
}

}  // namespace

std::vector<ProgramPosition> read_joint_state(std::string_view text, const std::string& path) {
  std::vector<ProgramPosition> positions;
  Scanner s(text, path);
  ProgramPosition message;
  double seconds = 0, nanoseconds = 0;
  bool stamped = false;
  const auto finish = [&] {
    if (!message.numbers.empty()) {
      if (message.joint_names.size() != message.numbers.size()) {
        s.fail_at(message.begin, "Found " + std::to_string(message.numbers.size()) + " positions and " + std::to_string(message.joint_names.size()) +
                                     " names in a message; expected as many.");
      }
      message.name = std::to_string(positions.size() + 1);
      message.radians = true;
      if (stamped) message.time_s = seconds + 1e-9 * nanoseconds;
      positions.push_back(std::move(message));
    }
    message = {};
    seconds = nanoseconds = 0;
    stamped = false;
  };
  while (!s.done()) {
    const std::size_t line = s.at();
    if (s.take("---")) {
      finish();
      s.skip_line();
    } else if (s.take("name:")) {
      list_items(s, [&] { message.joint_names.push_back(item(s)); });
    } else if (s.take("position:")) {
      message.begin = line;
      list_items(s, [&] { message.numbers.push_back(s.number()); });
    } else {
      s.skip_spaces();
      const bool sec = s.take("sec:") || s.take("secs:"), nano = !sec && (s.take("nanosec:") || s.take("nsecs:"));
      s.skip_spaces();
      if ((sec || nano) && s.at_number()) {
        (sec ? seconds : nanoseconds) = s.number().value;
        stamped = true;
      }
      s.skip_line();
    }
  }
  finish();
  return positions;
}

}  // namespace mdhcal::offline
