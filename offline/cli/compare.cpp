// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "offline/cli/calibration_arguments.hpp"
#include "offline/cli/messages.hpp"
#include "offline/error.hpp"
#include "offline/identify/rigid.hpp"
#include "offline/output/folder.hpp"

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

// (Li 2022, Table 9); mean is the source's "MAE". It gives no other figure.
struct Published {
  const char* method;
  double max, mean, sd;
};
constexpr Published published[] = {{"NC", 5.168, 2.533, 0.778},   {"LSM", 1.694, 1.445, 0.039},
                                   {"GD", 2.024, 1.353, 0.234},   {"GN", 1.204, 0.956, 0.111},
                                   {"RPIM", 0.583, 0.472, 0.026}};

bool is_published_robot(const std::string& name) {
  std::string plain;
  for (char ch : name) {
    if (ch != ' ') plain += static_cast<char>(ch >= 'A' && ch <= 'Z' ? ch - 'A' + 'a' : ch);
  }
  return plain.rfind("li2022", 0) == 0;
}

std::string table(const std::vector<Line>& lines, bool source, bool with_time) {
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
  if (source) {
    out += "published by the source (Li 2022, Table 9), on its own poses:\n";
    for (const Published& p : published) {
      std::snprintf(text, sizeof text, "%-12s %9.3f %9.3f %9.3f\n", p.method, p.max, p.mean, p.sd);
      out += text;
    }
  }
  return out;
}

std::string compare_json(const std::vector<Line>& lines, const char* split, std::size_t left_out) {
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
  return json.dump(2) + "\n";
}

void run(const CalibrationArguments& arguments) {
  const CalibrationOptions options = calibration_options(arguments);
  const Robot robot = read_robot(arguments.robot);
  const Dataset data = read_dataset(arguments.measurements, robot);
  Dataset test;
  if (!arguments.test.empty()) test = read_dataset(arguments.test, robot);
  OutputFolder folder(arguments.directory, {"compare.json", "compare.txt"});

  std::vector<Line> lines;
  std::vector<bool> counts;
  std::size_t left_out = 0;
  bool tested = false;
  for (const char* method : {"rpim", "rpim-train", "nc", "lsm", "gd", "gn", "lm", "ekf"}) {
    CalibrationOptions one = options;
    one.method = method;
    const auto start = std::chrono::steady_clock::now();
    const Calibration c = calibrate(robot, data, one, arguments.test.empty() ? nullptr : &test);
    Line line;
    line.time_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    if (counts.empty()) {
      tested = c.test.has_value();
      for (const RowResult& r : c.rows) {
        counts.push_back(r.test == tested && !r.outlier);
        left_out += r.test == tested && r.outlier ? 1 : 0;
      }
    }
    line.method = method;
    line.figures = figures_on(c, counts);
    for (const EstimatedParameter& p : c.parameters) line.deviation = std::max(line.deviation, 1e3 * std::fabs(p.deviation));
    line.iterations = c.iterations;
    line.converged = c.converged;
    if (!c.converged && !c.notes.empty()) line.note = c.notes.front();
    lines.push_back(line);
  }
  // The order of the source: from no calibration to its own method.
  std::rotate(lines.begin(), lines.begin() + 2, lines.end());
  std::string text = "position error [mm] on " + std::to_string(lines.front().figures.count) +
                     (tested ? " held-out rows" : " training rows (nothing was held out)") + ", " +
                     std::to_string(left_out) + " outliers left out; deviation: the largest of a parameter [mm or mrad]\n";
  const bool source = is_published_robot(robot.name);
  std::fputs((text + table(lines, source, true)).c_str(), stdout);

  folder.write("compare.json", compare_json(lines, tested ? "test" : "train", left_out));
  // The times change from run to run: they are on the screen only.
  folder.write("compare.txt", text + table(lines, source, false));
  folder.commit();
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
  command->callback([arguments] { run(*arguments); });
}

}  // namespace mdhcal::offline
