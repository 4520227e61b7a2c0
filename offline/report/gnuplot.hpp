// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace mdhcal::offline {

/// One figure: gnuplot commands that end in a plot, without terminal and output. `width` and `height` in pixels; `title` is
/// what a reader hears who cannot see it.
struct Figure {
  std::string title;
  std::string script;
  int width = 640, height = 360;
};

/// The figures as SVG elements to be put into one page: no XML declaration, and identifiers that differ between
/// figures. All are drawn by one gnuplot process, driven through a pipe. Empty if there is no gnuplot (searched in PATH)
/// or if it failed, or has not ended after `at_most` (it is then stopped); `reason` then says why. A report is drawn in a second or two:
/// a minute is for a machine that is busy with other things.
std::vector<std::string> draw(const std::vector<Figure>& figures, std::string& reason,
                              std::chrono::milliseconds at_most = std::chrono::minutes(1));

/// A gnuplot data block "$name << EOD ... EOD" of rows of numbers.
std::string data_block(const std::string& name, const std::vector<std::vector<double>>& rows);

}  // namespace mdhcal::offline
