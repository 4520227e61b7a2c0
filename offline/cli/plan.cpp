// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>

#include <nlohmann/json.hpp>

#include "offline/base/error.hpp"
#include "offline/base/folder.hpp"
#include "offline/base/progress.hpp"
#include "offline/cli/commands.hpp"
#include "offline/cli/messages.hpp"
#include "offline/cli/robot_argument.hpp"
#include "offline/measure/joint_file.hpp"
#include "offline/plan/plan.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {


struct PlanArguments {
  std::string robot, candidates, output, criterion = "position", base = "fit", tool = "fit";
  std::vector<double> tracker_mm, normal{0, 0, 1};
  std::vector<double> keep_out_mm;  // six numbers a box
  double cone_deg = 50, noise_mm = 0.02;
  PlanOptions options;
  bool json = false;
};

const std::map<std::string, Criterion>& criteria() {
  static const std::map<std::string, Criterion> names{
      {"d", Criterion::d}, {"a", Criterion::a}, {"e", Criterion::e}, {"position", Criterion::position}};
  return names;
}

Reach reach_of(const PlanArguments& arguments) {
  Reach reach;
  if (!arguments.tracker_mm.empty()) {
    reach.tracker_p_m = Vector3{};
    for (std::size_t k = 0; k < 3; ++k) (*reach.tracker_p_m)[k] = 1e-3 * arguments.tracker_mm[k];
  }
  const double length = std::hypot(arguments.normal[0], arguments.normal[1], arguments.normal[2]);
  if (!(length > 0)) throw InputError("Found the reflector normal 0, 0, 0; expected a direction (--normal 0 0 1).");
  for (std::size_t k = 0; k < 3; ++k) reach.reflector_normal[k] = arguments.normal[k] / length;
  reach.cone_rad = arguments.cone_deg * rad_per_deg;
  for (std::size_t at = 0; at + 6 <= arguments.keep_out_mm.size(); at += 6) {
    const double* box = arguments.keep_out_mm.data() + at;
    Box out;
    for (std::size_t k = 0; k < 3; ++k) {
      out.low_m[k] = 1e-3 * std::min(box[k], box[k + 3]);
      out.high_m[k] = 1e-3 * std::max(box[k], box[k + 3]);
    }
    reach.keep_out.push_back(out);
  }
  return reach;
}

std::string joints_csv(const Plan& plan, const Geometry& geometry) {
  const auto n = static_cast<std::size_t>(geometry.joint_count);
  std::string text = "id," + joint_header(geometry, "q") + '\n';
  for (std::size_t p = 0; p < plan.poses.size(); ++p) {
    text += std::to_string(p + 1);
    for (std::size_t i = 0; i < n; ++i) {
      char number[32];
      // A ten-thousandth of a degree and a tenth of a micrometre: what a controller takes.
      std::snprintf(number, sizeof number, ",%.4f",
                    plan.poses[p][i] * (geometry.joint[i].kind == JointKind::revolute ? deg_per_rad : 1e3));
      text += number;
    }
    text += '\n';
  }
  return text;
}

nlohmann::ordered_json position_json(const ExpectedPosition& p) {
  return {{"rms_mm", p.rms_mm}, {"p95_mm", p.p95_mm}, {"max_mm", p.max_mm}};
}

void print_json(const Plan& plan) {
  nlohmann::ordered_json json;
  json["poses"] = plan.poses.size();
  json["candidates"] = plan.candidates;
  json["unreachable"] = plan.unreachable;
  json["expected"] = position_json(plan.expected);
  json["random_median"] = position_json(plan.random_median);
  json["with_ten_more"] = position_json(plan.with_ten_more);
  json["parameters"] = nlohmann::ordered_json::array();
  for (const ExpectedParameter& p : plan.parameters) {
    const std::string unit = p.is_angle ? "_deg" : "_mm";
    const double factor = p.is_angle ? deg_per_rad : 1e3;
    json["parameters"].push_back({{"name", p.name},
                                  {"prior_sd" + unit, p.prior_sd * factor},
                                  {"expected_sd" + unit, p.expected_sd * factor}});
  }
  std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
}

void print_text(const Plan& plan) {
  std::printf("%zu poses of %zu candidates (%zu could not be measured)\n\n", plan.poses.size(), plan.candidates,
              plan.unreachable);
  std::printf("expected position error [mm]      rms       p95       max\n");
  const auto line = [](const char* label, const ExpectedPosition& p) {
    std::printf("%-28s %9.4f %9.4f %9.4f\n", label, p.rms_mm, p.p95_mm, p.max_mm);
  };
  line("these poses", plan.expected);
  line("as many random ones (median)", plan.random_median);
  line("with 10 further poses", plan.with_ten_more);
  std::printf("\nparameter   standard deviation before -> after\n");
  for (const ExpectedParameter& p : plan.parameters) {
    const double factor = p.is_angle ? deg_per_rad : 1e3;
    std::printf("%-8s %10.5f -> %.5f %s\n", p.name.c_str(), p.prior_sd * factor, p.expected_sd * factor,
                p.is_angle ? "deg" : "mm");
  }
}

void run_plan(PlanArguments& arguments) {
  const Robot robot = robot_of_argument(arguments.robot);
  std::vector<Joints> candidates;
  if (!arguments.candidates.empty()) {
    const auto table = read_joint_file(arguments.candidates, robot.geometry);
    for (const std::string& note : table.notes) inform(note);
    for (const auto& row : table.rows) candidates.push_back(row.q);
  }
  PlanOptions& options = arguments.options;
  options.criterion = criteria().at(arguments.criterion);
  options.reach = reach_of(arguments);
  options.unknowns.fit_base = arguments.base == "fit";
  options.unknowns.fit_tool = arguments.tool == "fit";
  if (!(arguments.noise_mm > 0)) throw InputError("Found --noise " + std::to_string(arguments.noise_mm) + "; expected a standard deviation above 0 mm.");
  options.unknowns.noise_mm = arguments.noise_mm;
  const Plan plan = [&] {
    Progress progress("plan", verbosity() != Verbosity::quiet);
    return make_plan(robot, options, candidates, progress.callback());
  }();
  write_file(arguments.output, joints_csv(plan, robot.geometry));
  if (arguments.json) {
    print_json(plan);
  } else {
    print_text(plan);
  }
  inform("Written to " + arguments.output + ".");
}

}  // namespace

void add_plan(CLI::App& app) {
  auto arguments = std::make_shared<PlanArguments>();
  CLI::App* command = app.add_subcommand("plan", "Choose the poses to measure, and say what to expect of them");
  command->add_option("ROBOT", arguments->robot, "Robot file, or a name of the catalogue")->required();
  command->add_option("--count", arguments->options.count, "Poses to choose")->required();
  command->add_option("-o,--output", arguments->output, "Joint table (CSV) to write, in a sensible order")->required();
  command->add_option("--candidates", arguments->candidates,
                      "Joint table to choose from (default: random configurations within the joint limits)");
  command->add_option("--draw", arguments->options.candidate_count, "Random configurations to choose from")
      ->capture_default_str();
  command->add_option("--criterion", arguments->criterion,
                      "d: smallest volume of uncertainty; a: smallest mean variance of the parameters; e: best worst "
                      "direction; position: smallest variance of the positions")
      ->check(CLI::IsMember({"d", "a", "e", "position"}))
      ->capture_default_str();
  command->add_option("--noise", arguments->noise_mm, "Standard deviation of a measured coordinate [mm]")
      ->capture_default_str();
  command->add_option("--base", arguments->base, "Whether the base frame will be fitted")
      ->check(CLI::IsMember({"fit", "given"}))
      ->capture_default_str();
  command->add_option("--tool", arguments->tool, "Whether the target point will be fitted")
      ->check(CLI::IsMember({"fit", "given"}))
      ->capture_default_str();
  command->add_option("--tracker", arguments->tracker_mm,
                      "Tracker position in the robot's base frame: X Y Z [mm]; then poses must be visible from there")
      ->expected(3);
  command->add_option("--normal", arguments->normal, "Reflector's axis in the flange frame: X Y Z")->expected(3);
  command->add_option("--cone", arguments->cone_deg, "Half angle within which the reflector returns the beam [deg]")
      ->capture_default_str();
  command->add_option("--keep-out", arguments->keep_out_mm,
                      "Box in the base frame that neither arm nor beam may enter: X1 Y1 Z1 X2 Y2 Z2 [mm]; repeatable")
      ->type_size(6)
      ->expected(1, CLI::detail::expected_max_vector_size);
  command->add_option("--seed", arguments->options.seed, "Seed of the random configurations")->capture_default_str();
  command->add_flag("--json", arguments->json, "Print the expectations as JSON");
  command->footer("Example:\n  mdhcal plan robot.toml --count 40 --tracker 2500 0 800 -o poses.csv");
  command->callback([arguments] { run_plan(*arguments); });
}

}  // namespace mdhcal::offline
