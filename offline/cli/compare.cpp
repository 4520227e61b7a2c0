// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "offline/base/error.hpp"
#include "offline/base/folder.hpp"
#include "offline/base/progress.hpp"
#include "offline/cli/calibration_arguments.hpp"
#include "offline/cli/messages.hpp"
#include "offline/cli/published.hpp"
#include "offline/cli/robot_argument.hpp"
#include "offline/report/write_result.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

struct Line {
  std::string method;
  Statistics figures;
  double deviation = 0;   // the largest, in mm or mrad
  int iterations = 0;
  bool converged = false;
  double time_ms = 0;
  std::string note;
};

// Every method is judged on the same rows: the held-out ones that the regularized method does not name as outliers.
Statistics figures_on(const Calibration& c, const std::vector<bool>& counts) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < c.rows.size(); ++i) {
    if (counts[i]) errors.push_back(norm(c.rows[i].after_mm));
  }
  return statistics(errors);
}

std::string table(const std::vector<Line>& lines, const std::vector<PublishedFigures>& published, bool with_time) {
  char text[256];
  std::snprintf(text, sizeof text, "%-12s %9s %9s %9s %9s %9s %10s %7s%s\n", "method", "max", "mean", "sd", "rms",
                "p95", "deviation", "steps", with_time ? "   time ms" : "");
  std::string out = text;
  for (const Line& line : lines) {
    const Statistics& s = line.figures;
    std::snprintf(text, sizeof text, "%-12s %9.4f %9.4f %9.4f %9.4f %9.4f %10.3f %7d", line.method.c_str(), s.max, s.mean,
                  s.sd, s.rms, s.p95, line.deviation, line.iterations);
    out += text;
    std::snprintf(text, sizeof text, " %9.1f", line.time_ms);
    if (with_time) out += text;
    out += line.converged ? "\n" : "  not converged\n";
  }
  if (!published.empty()) out += "published by the source (Li 2022, Table 9), on its own poses:\n";
  for (const PublishedFigures& p : published) {
    std::snprintf(text, sizeof text, "%-12s %9.3f %9.3f %9.3f\n", p.method.c_str(), p.max_mm, p.mean_mm, p.sd_mm);
    out += text;
  }
  return out;
}

std::string compare_json(const std::vector<Line>& lines, const std::vector<PublishedFigures>& published,
                         const char* split, std::size_t left_out) {
  nlohmann::ordered_json json;
  json["split"] = split;
  json["outliers_left_out"] = left_out;
  json["methods"] = nlohmann::ordered_json::array();
  for (const Line& line : lines) {
    const Statistics& s = line.figures;
    json["methods"].push_back({{"method", line.method},
                               {"count", s.count},
                               {"max_mm", s.max},
                               {"mean_mm", s.mean},
                               {"median_mm", s.median},
                               {"sd_mm", s.sd},
                               {"rms_mm", s.rms},
                               {"p95_mm", s.p95},
                               {"largest_deviation_mm_or_mrad", line.deviation},
                               {"iterations", line.iterations},
                               {"converged", line.converged},
                               {"note", line.note}});
  }
  json["published"] = nlohmann::ordered_json::array();
  for (const PublishedFigures& p : published) {
    json["published"].push_back(
        {{"method", p.method}, {"max_mm", p.max_mm}, {"mean_mm", p.mean_mm}, {"sd_mm", p.sd_mm}});
  }
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string report_of(const Calibration& regularized, const std::vector<Line>& lines,
                      const std::vector<PublishedFigures>& published) {
  ReportContext context;
  for (const Line& line : lines) context.methods.push_back({line.method, line.figures, line.note});
  for (const PublishedFigures& p : published) {
    Statistics s;
    s.max = p.max_mm, s.mean = p.mean_mm, s.sd = p.sd_mm;
    s.rms = s.p95 = std::nan("");
    context.methods.push_back({p.method + ", published", s, "on the source's own poses"});
  }
  return report_with_provenance(regularized, "", "", std::move(context));
}

struct Comparison {
  std::vector<Line> lines;   // from no calibration to the source's own method
  Calibration regularized;   // the method by which outliers are judged
  std::size_t left_out = 0;  // outliers
};

Comparison compare_methods(const Robot& robot, const Dataset& data, const CalibrationOptions& options,
                           const Dataset* test) {
  Comparison out;
  std::vector<bool> counts;
  Progress progress("compare", verbosity() != Verbosity::quiet);
  constexpr const char* methods[] = {"rpim", "rpim-train", "nc", "lsm", "gd", "gn", "lm", "ekf"};
  for (const char* method : methods) {
    CalibrationOptions one = options;
    one.method = method;
    one.cross_validate = false;
    const auto start = std::chrono::steady_clock::now();
    Calibration c = calibrate(robot, data, one, test);
    Line line;
    line.time_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    if (counts.empty()) {
      for (const RowResult& r : c.rows) {
        const bool judged = r.test == c.test.has_value();
        counts.push_back(judged && !r.outlier);
        out.left_out += judged && r.outlier ? 1 : 0;
      }
    }
    line.method = method;
    line.figures = figures_on(c, counts);
    for (const EstimatedParameter& p : c.parameters) {
      line.deviation = std::max(line.deviation, 1e3 * std::fabs(p.deviation));
    }
    line.iterations = c.iterations;
    line.converged = c.converged;
    if (!c.converged && !c.notes.empty()) line.note = c.notes.front();
    if (out.lines.empty()) out.regularized = std::move(c);
    out.lines.push_back(line);
    progress.update(out.lines.size(), std::size(methods));
  }
  std::rotate(out.lines.begin(), out.lines.begin() + 2, out.lines.end());
  return out;
}

void run_compare(const CalibrationArguments& arguments) {
  const CalibrationOptions options = calibration_options(arguments);
  const Robot robot = robot_of_argument(arguments.robot);
  const Dataset data = read_dataset(arguments.measurements, robot, arguments.rotation);
  Dataset test;
  if (!arguments.test.empty()) test = read_dataset(arguments.test, robot, arguments.rotation);
  OutputFolder folder(arguments.directory, {"compare.json", "compare.txt", "report.html"});
  const auto [lines, regularized, left_out] =
      compare_methods(robot, data, options, arguments.test.empty() ? nullptr : &test);

  const bool tested = regularized.test.has_value();
  const std::string text =
      "position error [mm] on " + std::to_string(lines.front().figures.count) +
      (tested ? " held-out rows" : " training rows (nothing was held out)") + ", " + std::to_string(left_out) +
      " outliers left out; deviation: the largest of a parameter [mm or mrad]\n";
  const std::vector<PublishedFigures> published = published_figures(robot);
  const std::string json = compare_json(lines, published, tested ? "test" : "train", left_out);
  folder.write("compare.json", json);
  // The times change from run to run: they are on the screen only.
  folder.write("compare.txt", text + table(lines, published, false));
  folder.write("report.html", report_of(regularized, lines, published));
  folder.commit();

  std::fputs(arguments.json ? json.c_str() : (text + table(lines, published, true)).c_str(), stdout);
  for (const std::string& note : data.notes) inform(note);
  for (const std::string& note : test.notes) inform(note);
  for (const std::string& decision : regularized.decisions) detail(decision);
  for (const std::string& note : regularized.notes) detail(note);
  for (const std::string& each : regularized.details) detail(each);
  for (const Line& line : lines) {
    if (!line.note.empty()) inform(line.method + ": " + line.note);
  }
}

}  // namespace

void add_compare(CLI::App& app) {
  auto arguments = std::make_shared<CalibrationArguments>();
  CLI::App* command = app.add_subcommand("compare", "Run every identification method on the same split");
  add_calibration_arguments(*command, *arguments);
  command->footer("Example:\n  mdhcal compare robot.toml nine.csv --test eighteen.csv --base given --tool given -o compared");
  command->callback([arguments] { run_compare(*arguments); });
}

}  // namespace mdhcal::offline
