// SPDX-License-Identifier: MIT
#include <array>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "offline/base/read_file.hpp"
#include "offline/batch/batch.hpp"
#include "offline/measure/joint_file.hpp"
#include "offline/report/html.hpp"

namespace mdhcal::offline {

namespace {

// A row of the summary. Figures are empty where there is no result or no test.
struct Line {
  std::string name, state, rows, outliers, judged, message;
  std::array<std::string, 6> figures;
};

constexpr std::array<const char*, 6> figure_names{"train_mean_before_mm", "train_mean_after_mm", "test_mean_before_mm",
                                                  "test_mean_after_mm",   "test_max_after_mm",   "test_p95_after_mm"};

std::string figure(const nlohmann::json& json, const char* set, const char* when, const char* key) {
  const nlohmann::json::json_pointer at("/" + std::string(set) + '/' + when + '/' + key);
  if (!json.contains(at) || !json[at].is_number()) return "";
  return number_cell(json[at].get<double>(), 6);
}

Line line_of(const BatchOutcome& outcome, const std::string& directory) {
  Line line;
  line.name = outcome.name;
  line.message = outcome.message;
  line.state = outcome.usable ? "done" : outcome.done ? "not usable" : "refused";
  if (!outcome.done) return line;
  const std::string path = (std::filesystem::path(directory) / outcome.name / "result.json").string();
  const auto json = nlohmann::json::parse(read_file(path, "a result"), nullptr, false);
  if (json.is_discarded()) {
    line.state = "unreadable";
    line.message = path + ": not JSON";
    return line;
  }
  // Without held-out rows those left out of folds judge.
  const nlohmann::json::json_pointer held_out("/test/after");
  const char* judged = json.contains(held_out) ? "test" : "cross_validation";
  line.judged = json.contains(held_out) ? "held out" : "cross-validated";
  line.figures = {figure(json, "train", "before", "mean_mm"), figure(json, "train", "after", "mean_mm"),
                  figure(json, judged, "before", "mean_mm"),  figure(json, judged, "after", "mean_mm"),
                  figure(json, judged, "after", "max_mm"),    figure(json, judged, "after", "p95_mm")};
  const nlohmann::json::json_pointer count("/train/after/count"), outliers("/outliers");
  if (json.contains(count) && json[count].is_number()) line.rows = std::to_string(json[count].get<long>());
  if (json.contains(outliers)) line.outliers = std::to_string(json[outliers].size());
  return line;
}

}  // namespace

std::string summary_csv(const std::vector<BatchOutcome>& outcomes, const std::string& directory) {
  std::string text = "name,state,rows,outliers";
  for (const char* name : figure_names) text += std::string(",") + name;
  text += ",judged_on,message\n";
  for (const BatchOutcome& outcome : outcomes) {
    const Line line = line_of(outcome, directory);
    text += csv_field(line.name) + ',' + line.state + ',' + line.rows + ',' + line.outliers;
    for (const std::string& value : line.figures) text += ',' + value;
    text += ',' + line.judged + ',' + csv_field(line.message) + '\n';
  }
  return text;
}

std::string summary_html(const std::vector<BatchOutcome>& outcomes, const std::string& directory) {
  std::vector<std::vector<std::string>> rows{{"robot", "state", "rows", "outliers"}};
  for (const char* name : figure_names) {
    std::string words = name;
    for (char& c : words) c = c == '_' ? ' ' : c;
    rows[0].push_back(words);
  }
  rows[0].push_back("judged on");
  std::size_t done = 0;
  std::string refused;
  for (const BatchOutcome& outcome : outcomes) {
    const Line line = line_of(outcome, directory);
    rows.push_back({escaped(line.name), line.state, line.rows, line.outliers});
    rows.back().insert(rows.back().end(), line.figures.begin(), line.figures.end());
    rows.back().push_back(line.judged);
    done += outcome.usable;
    if (!line.message.empty()) refused += "<li>" + escaped(line.name + ": " + line.message) + "</li>\n";
  }
  std::string body = "<h1>Batch of " + std::to_string(outcomes.size()) + " robots</h1>\n<p class=\"verdict\">" +
                     std::to_string(done) + " of " + std::to_string(outcomes.size()) + " calibrated and usable.</p>\n" + table(rows);
  if (!refused.empty()) body += section("Refused or not usable", "<ul>\n" + refused + "</ul>\n");
  return page("Batch of " + std::to_string(outcomes.size()) + " robots", body);
}

}  // namespace mdhcal::offline
