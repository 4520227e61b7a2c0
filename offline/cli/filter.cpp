// SPDX-License-Identifier: MIT
#include "offline/filter/filter.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "offline/base/error.hpp"
#include "offline/base/folder.hpp"
#include "offline/base/read_file.hpp"
#include "offline/base/sentences.hpp"
#include "offline/cli/blob_command.hpp"
#include "offline/cli/commands.hpp"
#include "offline/cli/messages.hpp"

namespace mdhcal::offline {

namespace {

struct FilterArguments {
  std::string program, blob, output, frames, tool, frame, controller;
  std::vector<std::string> keep;
  bool keep_taught = false;
  double sag_mm = 0.05;
};

bool nothing_to_correct(const BlobContent& model) {
  const auto same = [](const Link& a, const Link& b) {
    return std::equal_to<>()(a.alpha_rad, b.alpha_rad) && std::equal_to<>()(a.a_m, b.a_m) && std::equal_to<>()(a.theta_rad, b.theta_rad) &&
           std::equal_to<>()(a.d_m, b.d_m) && std::equal_to<>()(a.beta_rad, b.beta_rad);
  };
  const auto sags = [](double d) { return std::abs(d) > 0; };
  const Transmission& terms = model.transmission;
  return std::equal(model.nominal, model.nominal + model.geometry.joint_count, model.geometry.link, same) &&
         std::none_of(std::begin(terms.function), std::end(terms.function), [](const JointFunction& f) { return f.order_count > 0; }) &&
         std::none_of(std::begin(terms.gravity.direction), std::end(terms.gravity.direction), sags);
}

// A drawing's table: every axis parallel or square to the one before. A factory calibration has no such angle.
bool of_a_drawing(const BlobContent& model) {
  return std::all_of(model.nominal, model.nominal + model.geometry.joint_count,
                     [](const Link& link) { return std::abs(std::sin(2 * link.alpha_rad)) < 1e-12; });
}

// The nominal side of the blob must be what the controller computes with, or errors are corrected twice.
void check_controller(const FilterArguments& arguments, ProgramLanguage language, const BlobContent& model) {
  if (arguments.controller == "absolute") {
    throw Refusal("A controller that corrects its arm itself (--controller absolute: an accuracy option, a factory calibration that is not the blob's "
                  "nominal geometry) would correct this program a second time; expected the option switched off, or a calibration whose robot file "
                  "states what the controller computes with.");
  }
  if (nothing_to_correct(model)) warn(arguments.blob + ": the blob's corrected geometry is the nominal one: there is nothing to correct.");
  if (!arguments.controller.empty()) return;
  if (language == ProgramLanguage::urscript && of_a_drawing(model)) {
    warn("The blob's nominal geometry is a drawing's, and the controllers of Universal Robots compute with a factory calibration: calibrate with "
         "that as the robot file (mdhcal convert calibration.conf), or say --controller nominal.");
    return;
  }
  inform("The controller is taken to compute with the blob's nominal geometry, without an accuracy option (--controller nominal says so).");
}

void say(const FilterResult& result, const std::string& path) {
  for (const FilterNote& note : result.notes) inform(path + ':' + std::to_string(note.line) + ": " + note.text);
}

void run_filter(const FilterArguments& arguments) {
  const BlobArm blob = read_blob_arm(arguments.blob, PoseOptions{});
  const std::string text = read_file(arguments.program, "a robot program");
  const auto language = program_language(text);
  if (!language) {
    throw InputError(arguments.program, 0, 0, "Found no positions of a robot program; expected KRL (.dat), RAPID, FANUC LS, a Yaskawa job (JBI), VAL3 data "
                                              "(.dtx) or URScript.");
  }
  FilterOptions options;
  if (!arguments.frames.empty()) options.frames = read_frames(read_file(arguments.frames, "a file of frames and tools"), *language, arguments.frames);
  options.tool = arguments.tool;
  options.frame = arguments.frame;
  options.keep_taught = arguments.keep_taught;
  options.keep.insert(arguments.keep.begin(), arguments.keep.end());
  options.least_sag_m = arguments.sag_mm / 1e3;
  check_controller(arguments, *language, blob.model);
  const FilterResult result = filter_program(text, *language, arguments.program, blob.model, options);
  say(result, arguments.program);
  if (!result.stopped.empty()) {
    std::string all;
    for (const FilterNote& note : result.stopped) all += "\n  " + arguments.program + ':' + std::to_string(note.line) + ": " + note.text;
    throw Refusal("Not every target can be met; nothing was written." + all);
  }
  write_file(arguments.output, result.text);
  inform("Filtered " + std::to_string(result.filtered) + " of " + std::to_string(result.targets) + " targets of " + language_name(*language) +
         "; the flange moves by up to " + number(1e3 * result.most_moved_m) + " mm, the digits of the program leave up to " +
         number(1e3 * result.most_rounding_m) + " mm, " + std::to_string(result.flags_changed) + " configurations changed.");
}

}  // namespace

void add_filter(CLI::App& app) {
  auto arguments = std::make_shared<FilterArguments>();
  CLI::App* command = app.add_subcommand("filter", "Rewrite the targets of a robot program so that a nominal controller makes them true");
  command->add_option("PROGRAM", arguments->program, "Robot program: KRL, RAPID, FANUC LS, JBI, VAL3 data or URScript")->required();
  command->add_option("BLOB", arguments->blob, "Parameter blob of the arm")->required();
  command->add_option("-o,--output", arguments->output, "Program to write")->required();
  command->add_option("--frames", arguments->frames, "File with frames and tools (and pulses per degree) that the program names by number");
  command->add_option("--tool", arguments->tool, "Tool of targets for which the program has none: its name, or x,y,z and the rotation, in the program's "
                                                 "language and units");
  command->add_option("--frame", arguments->frame, "Frame of such targets, likewise");
  command->add_flag("--keep-taught", arguments->keep_taught, "Leave joint targets as they are: they were taught on the arm itself");
  command->add_option("--keep", arguments->keep, "Leave the target of this name as it is");
  command->add_option("--sag", arguments->sag_mm, "Name lines between filtered ends that leave their straight by more than this [mm]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--controller", arguments->controller, "What the controller computes with: the blob's nominal geometry, or a model of its own")
      ->check(CLI::IsMember({"nominal", "absolute"}));
  command->footer("Example:\n  mdhcal filter job.dat result/calibration.blob --frames config.dat -o filtered/job.dat");
  command->callback([arguments] { run_filter(*arguments); });
}

}  // namespace mdhcal::offline
