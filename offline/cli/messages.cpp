// SPDX-License-Identifier: MIT
#include "offline/cli/messages.hpp"

#include <unistd.h>

#include <cstdlib>

#include "offline/base/text.hpp"

namespace mdhcal::offline {

namespace {

Verbosity chosen = Verbosity::normal;

void line(const std::string& text) {
  // One write, so that lines of processes that share a terminal do not mix.
  const std::string whole = text + '\n';
  (void)std::fwrite(whole.data(), 1, whole.size(), stderr);
}

}  // namespace

void set_verbosity(Verbosity verbosity) { chosen = verbosity; }
Verbosity verbosity() { return chosen; }

void inform(const std::string& message) {
  if (chosen != Verbosity::quiet) line(printable(message));
}

void detail(const std::string& message) {
  if (chosen == Verbosity::verbose) line(printable(message));
}

void warn(const std::string& message) {
  if (chosen != Verbosity::quiet) line(coloured("warning:", Colour::yellow, stderr) + ' ' + printable(message));
}

void complain(const std::string& message) { line(coloured("mdhcal:", Colour::red, stderr) + ' ' + printable(message)); }

bool takes_colour(std::FILE* stream) {
  const char* refused = std::getenv("NO_COLOR");
  if (refused != nullptr && *refused != 0) return false;
  const char* terminal = std::getenv("TERM");
  if (terminal == nullptr || std::string_view(terminal) == "dumb") return false;
  return isatty(fileno(stream)) != 0;
}

std::string coloured(std::string_view text, Colour colour, std::FILE* stream) {
  if (!takes_colour(stream)) return std::string(text);
  const char* code = "1";
  switch (colour) {
    case Colour::bold: break;
    case Colour::green: code = "32"; break;
    case Colour::yellow: code = "33"; break;
    case Colour::red: code = "31"; break;
  }
  return std::string("\033[") + code + 'm' + std::string(text) + "\033[0m";
}

}  // namespace mdhcal::offline
