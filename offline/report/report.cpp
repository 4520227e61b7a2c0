// SPDX-License-Identifier: MIT
#include "offline/report/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "offline/report/figures.hpp"
#include "offline/report/html.hpp"
#include "offline/robot/rotation.hpp"
#include "offline/robot/units.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {


using Rows = std::vector<std::vector<std::string>>;

std::string list(const std::vector<std::string>& items) {
  if (items.empty()) return "";
  std::string out = "<ul>\n";
  for (const std::string& item : items) out += "<li>" + escaped(item) + "</li>\n";
  return out + "</ul>\n";
}

std::string paragraph(const std::string& text) { return "<p>" + escaped(text) + "</p>\n"; }

std::vector<std::string> figures_row(const std::string& label, const Statistics& s) {
  return {escaped(label),      std::to_string(s.count), number_cell(s.max, 4), number_cell(s.mean, 4),
          number_cell(s.median, 4), number_cell(s.sd, 4),          number_cell(s.rms, 4), number_cell(s.p95, 4)};
}

const std::vector<std::string> figures_header = {"position error [mm]", "rows", "max", "mean", "median", "SD", "RMS", "p95"};

void add_split(Rows& rows, const std::string& label, const SplitFigures& split) {
  rows.push_back(figures_row(label + ", before", split.before));
  rows.push_back(figures_row(label + ", after", split.after));
  if (!split.outliers.empty() && split.after_good.count > 0) {
    rows.push_back(figures_row(label + ", after, without the rows named", split.after_good));
  }
}

std::string accuracy_section(const Calibration& c) {
  Rows rows{figures_header};
  if (c.test) add_split(rows, "held out", *c.test);
  if (c.cross_validation) add_split(rows, "left out of folds", c.cross_validation->figures);
  add_split(rows, "training", c.train);
  std::string text = table(rows);
  Rows bounds{{"", "poses", "mean [mm]", "95 % bounds of the mean [mm]", "predicted mean [mm]"}};
  const auto add = [&](const char* label, const SplitFigures& f) {
    const bool known = std::isfinite(f.mean.high);
    bounds.push_back({label, std::to_string(f.poses), number_cell(f.after.mean, 4),
                      known ? number_cell(f.mean.low, 4) + " &hellip; " + number_cell(f.mean.high, 4) : "-",
                      number_cell(f.predicted_mean_mm, 4)});
  };
  if (c.test) add("held out", *c.test);
  if (c.cross_validation) add("left out of folds", c.cross_validation->figures);
  if (bounds.size() > 1) text += table(bounds);
  text += paragraph(c.test ? "Held-out rows entered nothing but these figures. \"Before\" is the nominal geometry after the "
                             "best fit of base and target on the training rows."
                           : "Nothing was held out. The rows left out of folds were predicted by fits that had not seen their "
                             "pose; the training rows were fitted, so they flatter.");
  return text;
}

std::string parameter_section(const Calibration& c) {
  Rows rows{{"parameter", "nominal", "corrected", "deviation", "standard deviation", "95 % interval of the deviation",
             "from the measurements"}};
  for (const EstimatedParameter& p : c.parameters) {
    const bool angle = is_angle(p.id);
    const double factor = angle ? deg_per_rad : 1e3;
    rows.push_back({"<span class=\"nowrap\">" + name(p.id) + (angle ? " [deg]" : " [mm]") + "</span>" +
                        (p.identifiable ? "" : "<span class=\"flag\">not identifiable from these poses</span>"),
                    number_cell(p.nominal * factor, 4),
                    number_cell((p.nominal + p.deviation) * factor, 4),
                    number_cell(p.deviation * factor, 4), number_cell(p.standard_deviation * factor, 4),
                    number_cell(p.low * factor, 4) + " &hellip; " + number_cell(p.high * factor, 4),
                    number_cell(100 * p.resolution, 0) + " %"});
  }
  std::string text = table(rows);
  text += paragraph("Intervals cover the geometry: the noise of the measurements and the bias of regularization. Compliance, "
                    "backlash and thermal drift are in no parameter; they stay in the residual.");
  if (!c.identifiability.weak.empty()) {
    Rows weak{{"weak or lost direction", "relative singular value", "advice"}};
    for (const WeakDirection& direction : c.identifiability.weak) {
      std::string members;
      for (const std::string& member : direction.members) members += (members.empty() ? "" : ", ") + member;
      char value[32];
      std::snprintf(value, sizeof value, "%.2g", direction.relative_singular_value);
      weak.push_back({escaped(members), value, escaped(direction.advice)});
    }
    text += table(weak, false);
  }
  return text;
}

std::string outlier_section(const Calibration& c) {
  Rows rows{{"row", "set", "line of the file", "error before [mm]", "error after [mm]"}};
  constexpr std::size_t most_rows = 200;  // four printed pages; residuals.csv marks all of them
  std::size_t outliers = 0;
  for (const RowResult& row : c.rows) {
    if (!row.outlier || ++outliers > most_rows) continue;
    rows.push_back({escaped(row_name(c, row)), row.test ? "held out" : "training",
                    std::to_string(measurement(c, row).line), number_cell(before_norm_mm(row), 4), number_cell(after_norm_mm(row), 4)});
  }
  const std::string threshold = number_cell(c.outlier_threshold_mm, 4);
  if (rows.size() == 1) {
    return paragraph("No training row is beyond the outlier threshold of " + threshold +
                     " mm, and no held-out row beyond what the model predicts for it.");
  }
  const std::string rest = outliers <= most_rows ? "" : " The first " + std::to_string(most_rows) + " of " + std::to_string(outliers) +
                                                              "; residuals.csv marks all.";
  return paragraph("Training rows beyond the outlier threshold of " + threshold +
                   " mm, which have no weight in the fit or little, and held-out rows beyond what the model predicts for them. "
                   "Look at them before you trust the rest." + rest) +
         table(rows);
}

std::string frames_section(const Calibration& c) {
  Rows rows{{"", "x [mm]", "y [mm]", "z [mm]", "rx [deg]", "ry [deg]", "rz [deg]"}};
  const Pose<double> base = pose_of(c.estimate.tracker_T_base);
  const auto turn = rotation_vector_of({base.quaternion[0], base.quaternion[1], base.quaternion[2], base.quaternion[3]});
  rows.push_back({c.layout.base ? "tracker_T_base, fitted" : "tracker_T_base, given", number_cell(1e3 * base.position_m[0], 4),
                  number_cell(1e3 * base.position_m[1], 4), number_cell(1e3 * base.position_m[2], 4), number_cell(deg_per_rad * turn[0], 5),
                  number_cell(deg_per_rad * turn[1], 5), number_cell(deg_per_rad * turn[2], 5)});
  const auto sd = [&](std::size_t column) {
    return column < c.covariance.size ? std::sqrt(std::max(0.0, c.covariance.at(column, column))) : std::nan("");
  };
  if (c.layout.base && c.covariance.size > 0) {
    rows.push_back({"standard deviation", number_cell(sd(3), 4), number_cell(sd(4), 4), number_cell(sd(5), 4), number_cell(1e-3 * deg_per_rad * sd(0), 5),
                    number_cell(1e-3 * deg_per_rad * sd(1), 5), number_cell(1e-3 * deg_per_rad * sd(2), 5)});
  }
  for (std::size_t t = 0; t < c.estimate.flange_p_m.size(); ++t) {
    const Vector3& p = c.estimate.flange_p_m[t];
    const std::string word = t < c.training.targets.size() && !c.training.targets[t].empty() ? " " + c.training.targets[t] : "";
    std::vector<std::string> row{"target" + escaped(word) + (c.layout.target ? ", fitted" : ", given"), number_cell(1e3 * p[0], 4),
                                 number_cell(1e3 * p[1], 4), number_cell(1e3 * p[2], 4), "", "", ""};
    const auto probe = std::find(c.layout.probes.begin(), c.layout.probes.end(), t);
    const bool turned = probe != c.layout.probes.end();
    const Vector3 probe_turn = log_of_rotation(probe_of(c.estimate, t));
    for (std::size_t k = 0; turned && k < 3; ++k) row[4 + k] = number_cell(deg_per_rad * probe_turn[k], 5);
    rows.push_back(std::move(row));
    if (c.layout.target && c.covariance.size > 0) {
      const std::size_t column = c.layout.base_columns() + 3 * t;
      row = {"standard deviation", number_cell(sd(column), 4), number_cell(sd(column + 1), 4), number_cell(sd(column + 2), 4), "", "", ""};
      const std::size_t first = c.layout.base_columns() + c.layout.target_columns() +
                                3 * static_cast<std::size_t>(probe - c.layout.probes.begin());
      for (std::size_t k = 0; turned && k < 3; ++k) row[4 + k] = number_cell(1e-3 * deg_per_rad * sd(first + k), 5);
      rows.push_back(std::move(row));
    }
  }
  return table(rows) + paragraph("The base in the frame of the measurements, its rotation as a rotation vector (standard "
                                 "deviations about the middle of the measured points); target points in the flange frame, with the turn "
                                 "of the probe on the flange where rotations were measured.");
}

std::string method_section(const std::vector<MethodFigures>& methods) {
  Rows rows{{"method", "max [mm]", "mean [mm]", "SD [mm]", "RMS [mm]", "p95 [mm]", ""}};
  for (const MethodFigures& m : methods) {
    rows.push_back({escaped(m.method), number_cell(m.figures.max, 4), number_cell(m.figures.mean, 4), number_cell(m.figures.sd, 4),
                    number_cell(m.figures.rms, 4), number_cell(m.figures.p95, 4), escaped(m.note)});
  }
  return table(rows);
}

std::string figure_block(const std::string& svg, const std::string& caption) {
  return "<figure>\n" + svg + "\n<figcaption>" + escaped(caption) + "</figcaption>\n</figure>\n";
}

std::string scientific(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

}  // namespace

std::string report_html(const Calibration& c, const ReportContext& context) {
  const bool lambda = !c.lambda.choices.empty() && !c.lambda.l_curve.empty();
  const PredictedAccuracy& accuracy = c.accuracy;

  std::vector<Figure> figures{distribution_figure(c), per_pose_figure(c), axes_figure(c), vectors_figure(c),
                              spectrum_figure(c)};
  if (!accuracy.points.empty()) figures.push_back(accuracy_figure(accuracy));
  if (lambda) figures.push_back(lambda_figure(c.lambda));
  std::string reason;
  const std::vector<std::string> drawn = draw(figures, reason);
  const auto shown = [&](std::size_t k) { return drawn.empty() ? "" : figure_block(drawn[k], figures[k].title + "."); };
  const std::size_t lambda_index = figures.size() - 1;

  const std::string title = "Calibration of " + (c.robot.name.empty() ? "a robot" : c.robot.name);
  std::string body = "<h1>" + escaped(title) + "</h1>\n";
  body += "<p class=\"verdict\">" + escaped(c.verdict) + "</p>\n";
  if (!c.usable()) body += section(c.released() ? "Accepted against these reasons" : "Not usable", list(c.reasons));
  if (drawn.empty()) body += paragraph("This report has no figures: " + reason + ". Everything else is complete.");
  body += section("Accuracy", accuracy_section(c) + shown(0) + shown(1));
  body += section("Where the errors are", shown(2) + shown(3) + outlier_section(c));
  body += section("Parameters", parameter_section(c) + shown(4) +
                                    paragraph("Rank " + std::to_string(c.identifiability.after.rank) + " of " +
                                              std::to_string(c.identifiability.after.singular_values.size()) +
                                              ", condition " + scientific(c.identifiability.after.condition) + ", with the penalty " +
                                              scientific(c.identifiability.condition_regularized) + '.'));
  if (!accuracy.points.empty()) {
    body += section("Predicted accuracy over the workspace",
                    paragraph("Standard deviation of the corrected position at 600 random configurations within the joint "
                              "limits: median " + number_cell(accuracy.median_mm, 4) + " mm, 95 % below " + number_cell(accuracy.p95_mm, 4) +
                              " mm, largest " + number_cell(accuracy.max_mm, 4) + " mm.") + shown(5));
  }
  std::string choice = paragraph("Lambda " + scientific(c.lambda.lambda) + " by the rule \"" + c.lambda.rule + "\". " + c.lambda.note);
  if (lambda) {
    Rows rows{{"rule", "lambda", "residual norm", "norm of the deviations"}};
    for (const LambdaReport::Choice& each : c.lambda.choices) {
      rows.push_back({escaped(each.rule), scientific(each.lambda), scientific(each.residual_norm), scientific(each.solution_norm)});
    }
    choice += table(rows) + shown(lambda_index);
    if (!c.lambda.silent.empty()) choice += paragraph("Rules without a choice here:") + list(c.lambda.silent);
  }
  body += section("Regularization", choice);
  body += section("Registration and target", frames_section(c));
  if (!context.methods.empty()) body += section("Methods compared", method_section(context.methods));
  Rows dependences{{"quantity", "rows", "mean residual x, y, z [mm]", "correlation with the error"}};
  for (const Dependence& d : c.dependences) {
    dependences.push_back({escaped(d.quantity), std::to_string(d.count),
                           number_cell(d.mean_residual_mm[0], 4) + ", " + number_cell(d.mean_residual_mm[1], 4) + ", " +
                               number_cell(d.mean_residual_mm[2], 4),
                           number_cell(d.correlation, 2)});
  }
  if (dependences.size() > 1) body += section("What the residual goes with", table(dependences));
  std::vector<std::string> remarks = c.notes;
  remarks.insert(remarks.end(), c.decisions.begin(), c.decisions.end());
  body += section("Notes and decisions", list(remarks));
  Rows provenance{{"", ""}};
  provenance.push_back({"method", escaped(c.method)});
  for (const auto& [label, value] : context.provenance) {
    provenance.push_back({escaped(label), "<code>" + escaped(value) + "</code>"});
  }
  body += section("Provenance", table(provenance, false));
  return page(title, body);
}

}  // namespace mdhcal::offline
