// SPDX-License-Identifier: MIT
#include "offline/report/figures.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "offline/robot/rotation.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

// Told apart in grey print as well (Okabe & Ito's vermilion and blue differ in lightness).
constexpr const char* before_colour = "rgb '#d55e00'";
constexpr const char* after_colour = "rgb '#0072b2'";

double norm_mm(const Vector3& v) { return std::hypot(v[0], v[1], v[2]); }

std::string text_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.7g", value);
  return text;
}

// The rows that the headline figures are about: held out if there are any.
std::vector<const RowResult*> judged(const Calibration& calibration) {
  std::vector<const RowResult*> rows;
  for (const RowResult& row : calibration.rows) {
    if (row.test == calibration.test.has_value()) rows.push_back(&row);
  }
  return rows;
}

// A picture is 720 pixels wide: two marks for each column of pixels. More are not seen, and a page of 10^5 of them does not open.
constexpr std::size_t most_drawn = 1440;

// How many neighbours share one mark.
std::size_t neighbours(std::size_t rows) { return (rows + most_drawn - 1) / most_drawn; }

// Which of `candidates` are drawn, in their order: all, or of every so many neighbours the one with the largest error. What
// stands out is never left out.
std::vector<std::size_t> drawn(const Calibration& calibration, const std::vector<std::size_t>& candidates) {
  const std::size_t step = neighbours(candidates.size());
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < candidates.size(); i += step) {
    const auto begin = candidates.begin() + static_cast<std::ptrdiff_t>(i);
    const auto end = candidates.begin() + static_cast<std::ptrdiff_t>(std::min(i + step, candidates.size()));
    rows.push_back(*std::max_element(begin, end, [&](std::size_t a, std::size_t b) {
      return norm_mm(calibration.rows[a].after_mm) < norm_mm(calibration.rows[b].after_mm);
    }));
  }
  return rows;
}

// What a caption says of that.
std::string thinned(std::size_t candidates) {
  const std::size_t step = neighbours(candidates);
  return step <= 1 ? "" : "; of every " + std::to_string(step) + " rows the one with the largest error after";
}

template <class Keep>
std::vector<std::size_t> rows_that(const Calibration& calibration, Keep keep) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < calibration.rows.size(); ++i) {
    if (keep(calibration.rows[i])) rows.push_back(i);
  }
  return rows;
}

// Error norms in ascending order with the share of rows at or below each: of all rows, or of so many steps up to the largest.
std::vector<std::vector<double>> cumulative(std::vector<double> errors) {
  std::sort(errors.begin(), errors.end());
  std::vector<std::vector<double>> rows;
  const std::size_t step = neighbours(errors.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if ((errors.size() - 1 - i) % step != 0) continue;
    rows.push_back({errors[i], 100.0 * static_cast<double>(i + 1) / static_cast<double>(errors.size())});
  }
  return rows;
}

// Middle, count and width of each bin. Bins are equally wide on a logarithmic axis, eight a decade: before and after
// differ by orders of magnitude, and so does an outlier from the rest.
std::vector<std::vector<double>> histogram(const std::vector<double>& errors) {
  constexpr double bins_per_decade = 8;
  std::map<long, double> counts;
  for (const double error : errors) counts[std::lround(std::floor(std::log10(error) * bins_per_decade))] += 1;
  std::vector<std::vector<double>> rows;
  for (const auto& [bin, count] : counts) {
    const double low = std::pow(10, static_cast<double>(bin) / bins_per_decade);
    const double high = std::pow(10, static_cast<double>(bin + 1) / bins_per_decade);
    rows.push_back({(low + high) / 2, count, high - low});
  }
  return rows;
}

// The largest of 1, 2, 5, 10, ... that is not above the value.
double round_step(double value) {
  const double decade = std::pow(10, std::floor(std::log10(value)));
  return (value >= 5 * decade ? 5 : value >= 2 * decade ? 2 : 1) * decade;
}

double nonzero(double value) { return std::max(value, 1e-6); }

}  // namespace

double before_norm_mm(const RowResult& row) { return norm_mm(row.before_mm); }
double after_norm_mm(const RowResult& row) { return norm_mm(row.after_mm); }

const Measurement& measurement(const Calibration& calibration, const RowResult& row) {
  return (row.test ? calibration.testing : calibration.training).rows[row.row];
}

std::string row_name(const Calibration& calibration, const RowResult& row) {
  const Dataset& data = row.test ? calibration.testing : calibration.training;
  return row_name(data, data.rows[row.row]);
}

Figure distribution_figure(const Calibration& calibration) {
  std::vector<double> before, after;
  for (const RowResult* row : judged(calibration)) {
    before.push_back(nonzero(before_norm_mm(*row)));
    after.push_back(nonzero(after_norm_mm(*row)));
  }
  Figure figure{std::string("Histogram and cumulative curve of the position error of the ") +
                    (calibration.test ? "held-out" : "training") + " rows",
                "", 720, 300};
  figure.script = data_block("bars_before", histogram(before)) + data_block("bars_after", histogram(after)) +
                  data_block("before", cumulative(before)) + data_block("after", cumulative(after)) +
                  "set multiplot layout 1,2\nset grid\nset style fill solid 0.6\nset logscale x\nset format x '%g'\n"
                  "set xlabel 'error [mm]'\nset ylabel 'rows'\nset yrange [0:*]\nset key outside top horizontal\n"
                  "plot $bars_before using 1:2:3 with boxes lc " + before_colour + " title 'before', "
                  "$bars_after using 1:2:3 with boxes lc " + after_colour + " title 'after'\n"
                  "set yrange [0:100]\nset ylabel 'rows at or below [%]'\n"
                  "plot $before using 1:2 with steps lw 2 lc " + before_colour + " title 'before', "
                  "$after using 1:2 with steps lw 2 lc " + after_colour + " title 'after'\nunset multiplot";
  return figure;
}

Figure per_pose_figure(const Calibration& calibration) {
  std::vector<std::vector<double>> before, after, outliers;
  double first_test = 0;
  const auto all = rows_that(calibration, [](const RowResult&) { return true; });
  for (const std::size_t i : drawn(calibration, all)) {
    const RowResult& row = calibration.rows[i];
    const auto at = static_cast<double>(i + 1);
    before.push_back({at, nonzero(before_norm_mm(row))});
    after.push_back({at, nonzero(after_norm_mm(row))});
    if (row.outlier) outliers.push_back({at, nonzero(after_norm_mm(row))});
  }
  const auto test = std::find_if(calibration.rows.begin(), calibration.rows.end(), [](const RowResult& row) { return row.test; });
  if (test != calibration.rows.end()) first_test = static_cast<double>(test - calibration.rows.begin()) + 0.5;
  Figure figure{"Error of each row before and after" + thinned(all.size()), "", 720, 300};
  figure.script = data_block("before", before) + data_block("after", after);
  if (!outliers.empty()) figure.script += data_block("outliers", outliers);
  figure.script += "set logscale y\nset grid\nset xlabel 'row'\nset ylabel 'error [mm]'\nset key outside top horizontal\n"
                   "set xrange [0:" + text_of(static_cast<double>(calibration.rows.size()) + 1) + "]\n";
  if (first_test > 1) {
    figure.script += "set arrow from " + text_of(first_test) + ", graph 0 to " + text_of(first_test) +
                     ", graph 1 nohead dt 2 lc rgb '#444444'\nset label 'held out' at " + text_of(first_test) +
                     ", graph 0.96 offset 0.5,0\n";
  }
  figure.script += "plot $before with points pt 6 ps 0.6 lc " + std::string(before_colour) + " title 'before', "
                   "$after with points pt 7 ps 0.5 lc " + after_colour + " title 'after'";
  if (!outliers.empty()) figure.script += ", $outliers with points pt 6 ps 1.6 lw 1.5 lc rgb 'black' title 'outlier'";
  return figure;
}

Figure axes_figure(const Calibration& calibration) {
  std::vector<std::vector<double>> rows;
  const auto good = rows_that(calibration, [](const RowResult& row) { return !row.outlier; });
  for (const std::size_t i : drawn(calibration, good)) {
    const RowResult& row = calibration.rows[i];
    rows.push_back({static_cast<double>(i + 1), row.after_mm[0], row.after_mm[1], row.after_mm[2]});
  }
  if (rows.empty()) rows.push_back({0, 0, 0, 0});
  Figure figure{"Residual along each axis of the measurement frame, outliers left out" + thinned(good.size()), "", 720, 480};
  figure.script = data_block("r", rows) + "set multiplot layout 3,1\nset grid\nset tmargin 0.5\nset bmargin 2\n"
                  "set lmargin 12\nset xzeroaxis\nset xrange [0:" +
                  text_of(static_cast<double>(calibration.rows.size()) + 1) + "]\n";
  const char* names[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    double largest = 1e-6;
    for (const auto& row : rows) largest = std::max(largest, std::abs(row[static_cast<std::size_t>(k) + 1]));
    figure.script += "set yrange [" + text_of(-1.1 * largest) + ':' + text_of(1.1 * largest) + "]\nset ytics " +
                     text_of(round_step(largest)) + "\nset ylabel '" + names[k] + " [mm]'\nplot $r using 1:" + std::to_string(k + 2) +
                     " with points pt 7 ps 0.4 lc " + after_colour + " notitle\n";
  }
  figure.script += "unset multiplot";
  return figure;
}

Figure vectors_figure(const Calibration& calibration) {
  const Frame<double> base_T_tracker = inverted(calibration.estimate.tracker_T_base);
  std::vector<std::vector<double>> rows;
  double longest = 0, extent = 0;
  Vector3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  const auto points = rows_that(calibration, [&](const RowResult& row) {
    const MeasurementKind kind = measurement(calibration, row).kind;
    return !row.outlier && (kind == MeasurementKind::position || kind == MeasurementKind::pose);
  });
  for (const std::size_t i : drawn(calibration, points)) {
    const RowResult& row = calibration.rows[i];
    const Measurement& m = measurement(calibration, row);
    const Vector3 p = transform(base_T_tracker, m.position_m);
    const Vector3 e = rotate(base_T_tracker, row.after_mm);
    rows.push_back({1e3 * p[0], 1e3 * p[1], 1e3 * p[2], e[0], e[1], e[2], norm_mm(e)});
    longest = std::max(longest, norm_mm(e));
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], 1e3 * p[k]);
      high[k] = std::max(high[k], 1e3 * p[k]);
    }
  }
  for (std::size_t k = 0; k < 3 && !rows.empty(); ++k) extent = std::max(extent, high[k] - low[k]);
  if (rows.empty()) rows.push_back({0, 0, 0, 0, 0, 0, 0});
  // The longest arrow takes an eighth of the workspace; the factor is a round number and stands in the caption.
  double factor = longest > 0 && extent > 0 ? extent / 8 / longest : 1;
  factor = std::pow(10, std::floor(std::log10(factor)));
  Figure figure{"Error vectors after calibration, enlarged " + text_of(factor) + " times, in the robot's base frame" +
                    thinned(points.size()),
                "", 720, 420};
  figure.script = data_block("v", rows) + "f = " + text_of(factor) +
                  "\nset xlabel 'x [mm]'\nset ylabel 'y [mm]'\nset zlabel 'z [mm]' rotate\nset grid\nset view 62,38,1,1.15\nset tmargin 0\nset bmargin 0\n"
                  "set xyplane 0.05\nset tics font ',9'\nset cblabel 'error [mm]'\n"
                  "set palette defined (0 '#440154', 0.5 '#21908c', 1 '#fde725')\n"
                  "splot $v using 1:2:3:($4*f):($5*f):($6*f):7 with vectors head size graph 0.01,20 lw 1.2 lc palette notitle";
  return figure;
}

Figure lambda_figure(const LambdaReport& lambda) {
  std::vector<std::vector<double>> curve;
  for (const LambdaReport::Point& p : lambda.l_curve) curve.push_back({p.residual_norm, p.solution_norm});
  Figure figure{"L-curve with the choices of the rules", "", 720, 380};
  figure.script = data_block("curve", curve);
  std::string plots = "$curve with lines lw 2 lc rgb '#999999' title 'L-curve'";
  // Rules often agree: open marks, each another shape and size, so that none hides another.
  constexpr int shapes[] = {7, 4, 8, 12, 6, 10, 14, 1, 2};
  for (std::size_t k = 0; k < lambda.choices.size(); ++k) {
    const LambdaReport::Choice& choice = lambda.choices[k];
    const std::string name = "c" + std::to_string(k);
    figure.script += data_block(name, {{choice.residual_norm, choice.solution_norm}});
    plots += ", $" + name + " with points pt " + std::to_string(shapes[k % std::size(shapes)]) + " ps " +
             text_of(k == 0 ? 1.0 : 1.1 + 0.2 * static_cast<double>(k)) + " lw 1.6 lt " + std::to_string(k + 1) + " title '" +
             choice.rule + "'";
  }
  figure.script += "set logscale xy\nset grid\nset xlabel 'residual norm'\nset ylabel 'norm of the deviations [prior sd]'\n"
                   "set offsets graph 0.05, graph 0.05, 0, 0\nset key outside right\nplot " + plots;
  return figure;
}

Figure spectrum_figure(const Calibration& calibration) {
  const Spectrum& spectrum = calibration.identifiability.after;
  std::vector<std::vector<double>> rows;
  for (std::size_t k = 0; k < spectrum.singular_values.size(); ++k) {
    rows.push_back({static_cast<double>(k + 1), std::max(spectrum.singular_values[k], 1e-16)});
  }
  if (rows.empty()) rows.push_back({1, 1});
  const double smallest = std::max(rows.back()[1] / 3, 1e-17);
  Figure figure{"Singular values of the column-scaled Jacobian, base and targets projected out", "", 720, 280};
  figure.script = data_block("s", rows) + "set logscale y\nset grid\nset xlabel 'index'\nset ylabel 'singular value'\n"
                  "set xrange [0:" + text_of(static_cast<double>(rows.size()) + 1) + "]\nset yrange [" + text_of(smallest) +
                  ":*]\n";
  if (spectrum.rank < rows.size()) {
    const std::string at = text_of(static_cast<double>(spectrum.rank) + 0.5);
    figure.script += "set arrow from " + at + ", graph 0 to " + at + ", graph 1 nohead dt 2\nset label 'cut' at " + at +
                     ", graph 0.9 offset 0.5,0\n";
  }
  figure.script += "plot $s with impulses lw 3 lc " + std::string(after_colour) + " notitle, $s with points pt 7 ps 0.6 lc " +
                   after_colour + " notitle";
  return figure;
}

Figure accuracy_figure(const PredictedAccuracy& accuracy) {
  Figure figure{"Predicted standard deviation of the position over the workspace, robot's base frame", "", 720, 420};
  std::vector<std::vector<double>> points;
  for (const auto& point : accuracy.points) points.emplace_back(point.begin(), point.end());
  figure.script = data_block("p", points) +
                  "set xlabel 'x [mm]'\nset ylabel 'y [mm]'\nset zlabel 'z [mm]' rotate\nset grid\nset view 62,38,1,1.15\nset tmargin 0\nset bmargin 0\n"
                  "set xyplane 0.05\nset tics font ',9'\nset cblabel 'standard deviation [mm]'\n"
                  "set palette defined (0 '#440154', 0.5 '#21908c', 1 '#fde725')\n"
                  "splot $p using 1:2:3:4 with points pt 7 ps 0.6 lc palette notitle";
  return figure;
}

}  // namespace mdhcal::offline
