// SPDX-License-Identifier: MIT
#include "offline/report/report.hpp"

#include <cmath>
#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "offline/identify/regularized.hpp"
#include "offline/report/html.hpp"
#include "offline/simulate/family.hpp"
#include "offline/simulate/simulate.hpp"
#include "tests/support/program.hpp"

namespace {

using namespace mdhcal::offline;
using namespace mdhcal::tests;

const Calibration& sample() {
  static const Calibration calibration = [] {
    SimulationOptions options;
    options.outlier_fraction = 0.05;
    options.test_configurations = 60;
    const Simulation s = simulate(family_robot("three-parallel"), options);
    Robot robot = s.nominal;
    robot.name = "arm <7> & \"friends\"";
    return calibrate(robot, s.train, {}, &s.test);
  }();
  return calibration;
}

const std::string& sample_report() {
  static const std::string html =
      report_html(sample(), {{{"tool", "mdhcal"}, {"SHA-256 of calibration.blob", "abc"}}, {{"lsm", {}, "diverged"}}});
  return html;
}

TEST(Report, HoldsEverySectionAndEveryFigure) {
  const std::string& html = sample_report();
  for (const char* heading : {"Accuracy", "Where the errors are", "Parameters", "Predicted accuracy over the workspace",
                              "Regularization", "Registration and target", "Methods compared", "Notes and decisions", "Provenance"}) {
    EXPECT_NE(html.find("<h2>" + std::string(heading) + "</h2>"), std::string::npos) << heading;
  }
  std::size_t figures = 0;
  for (std::size_t at = 0; (at = html.find("<svg", at)) != std::string::npos; ++at) ++figures;
  EXPECT_EQ(figures, 7u);
  EXPECT_NE(html.find(escaped(sample().verdict)), std::string::npos);
  EXPECT_NE(html.find("arm &lt;7&gt; &amp; &quot;friends&quot;"), std::string::npos);
  for (const EstimatedParameter& p : sample().parameters) {
    EXPECT_NE(html.find('>' + name(p.id) + (is_angle(p.id) ? " [deg]" : " [mm]") + "</span>"), std::string::npos) << name(p.id);
  }
  for (const std::string& outlier : sample().train.outliers) {
    EXPECT_NE(html.find("<td>" + outlier + "</td><td>training</td>"), std::string::npos) << outlier;
  }
  EXPECT_NE(html.find(number_cell(sample().test->after.mean, 4)), std::string::npos);
  // Each rule has its mark on the L-curve and its line in the table, or is named among those without a choice.
  for (const auto& [rule, unused] : lambda_rules) {
    const std::string word(rule);
    const bool chosen = word == sample().lambda.rule;
    const bool table = html.find("<td>" + word + (chosen ? " (chosen)" : "") + "</td>") != std::string::npos;
    const bool mark = html.find('>' + word + (chosen ? " (chosen)" : "") + "</tspan>") != std::string::npos;
    const bool silent = html.find("<li>" + word + ": ") != std::string::npos;
    EXPECT_NE(mark, silent) << word;
    EXPECT_TRUE(silent || table) << word;
  }
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_EQ(html.find(">nan"), std::string::npos);
}

TEST(Report, IsTheSameEveryTime) {
  EXPECT_EQ(report_html(sample(), {{{"tool", "mdhcal"}, {"SHA-256 of calibration.blob", "abc"}}, {{"lsm", {}, "diverged"}}}),
            sample_report());
}

TEST(Report, WithoutGnuplotSaysSoAndKeepsItsTables) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nonexistent", 1);
  const std::string html = report_html(sample(), {});
  setenv("PATH", path.c_str(), 1);
  EXPECT_NE(html.find("This report has no figures: gnuplot"), std::string::npos);
  EXPECT_EQ(html.find("<svg"), std::string::npos);
  EXPECT_NE(html.find(">alpha2 [deg]</span>"), std::string::npos);
}

// Opened as a user would: nothing is fetched but the file itself, and the console stays silent.
TEST(Report, OpensInABrowserWithoutErrorsOrRequests) {
  const TemporaryFolder folder;
  write_bytes(folder / "report.html", sample_report());
  const auto run = run_program(
      "chromium", {"--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-sync",
                   "--disable-component-update", "--disable-default-apps", "--no-first-run", "--disable-extensions", "--disable-features=NetworkTimeServiceQuerying",
                   "--user-data-dir=" + (folder / "profile"), "--enable-logging=stderr", "--log-level=0",
                   "--log-net-log=" + (folder / "net.json"), "--net-log-capture-mode=Everything", "--virtual-time-budget=2000",
                   "--dump-dom", "file://" + (folder / "report.html")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("</svg>"), std::string::npos);
  EXPECT_EQ(run.err.find("CONSOLE"), std::string::npos) << run.err;
  const auto log = nlohmann::json::parse(read_bytes(folder / "net.json"), nullptr, false);
  ASSERT_FALSE(log.is_discarded());
  EXPECT_EQ(sample_report().find("google"), std::string::npos);
  for (const auto& event : log["events"]) {
    if (!event.contains("params") || !event["params"].contains("url")) continue;
    const std::string url = event["params"]["url"];
    if (url.find("google") != std::string::npos) continue;  // the browser's own services; the page names none of them
    EXPECT_TRUE(url.starts_with("file://") || url.starts_with("data:") || url.starts_with("chrome")) << url;
  }
}

}  // namespace
