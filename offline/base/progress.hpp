// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <mutex>
#include <string>

namespace mdhcal::offline {

/// What a long computation calls as it goes on: units done so far and units in all. It may be called from any thread.
using ProgressCallback = std::function<void(std::size_t done, std::size_t total)>;

/// One line of progress, without its end: "compare 12/60 (20 %), 4 s left". No estimate before the first unit.
std::string progress_line(const std::string& what, std::size_t done, std::size_t total, double elapsed_s);

/// A line on stderr that says how far a computation is. It appears only if stderr is a terminal, only after the first
/// second, at most five times a second, and is wiped when the object goes.
class Progress {
 public:
  /// `enabled` is false under --quiet.
  explicit Progress(std::string what, bool enabled = true);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void update(std::size_t done, std::size_t total);
  /// A callback that updates this object, which must outlive it.
  ProgressCallback callback();

 private:
  using Clock = std::chrono::steady_clock;
  const std::string what_;
  const bool enabled_;
  const Clock::time_point start_;
  std::mutex mutex_;
  Clock::time_point last_;
  bool drawn_ = false;
};

}  // namespace mdhcal::offline
