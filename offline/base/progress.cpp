// SPDX-License-Identifier: MIT
#include "offline/base/progress.hpp"

#include <cmath>
#include <cstdio>

#include <unistd.h>

namespace mdhcal::offline {

namespace {

std::string duration(double seconds) {
  const long whole = std::lround(std::ceil(seconds));
  if (whole < 120) return std::to_string(whole) + " s";
  if (whole < 7200) return std::to_string((whole + 59) / 60) + " min";
  return std::to_string((whole + 3599) / 3600) + " h";
}

}  // namespace

std::string progress_line(const std::string& what, std::size_t done, std::size_t total, double elapsed_s) {
  std::string line = what + ' ' + std::to_string(done) + '/' + std::to_string(total);
  if (done == 0 || total == 0) return line;
  line += " (" + std::to_string(100 * done / total) + " %)";
  if (done < total) {
    line += ", " + duration(elapsed_s * static_cast<double>(total - done) / static_cast<double>(done)) + " left";
  }
  return line;
}

Progress::Progress(std::string what, bool enabled)
    : what_(std::move(what)), enabled_(enabled && isatty(STDERR_FILENO) != 0), start_(Clock::now()), last_(start_) {}

Progress::~Progress() {
  if (drawn_) std::fputs("\r\033[K", stderr);
}

void Progress::update(std::size_t done, std::size_t total) {
  using namespace std::chrono_literals;
  if (!enabled_) return;
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  if (now - start_ < 1s || now - last_ < 200ms) return;
  last_ = now;
  drawn_ = true;
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  std::fprintf(stderr, "\r\033[K%s", progress_line(what_, done, total, elapsed_s).c_str());
  std::fflush(stderr);
}

ProgressCallback Progress::callback() {
  return [this](std::size_t done, std::size_t total) { update(done, total); };
}

}  // namespace mdhcal::offline
