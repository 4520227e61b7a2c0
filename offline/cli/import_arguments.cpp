// SPDX-License-Identifier: MIT
#include "offline/cli/import_arguments.hpp"

#include "offline/base/error.hpp"
#include "offline/import/meaning.hpp"
#include "offline/measure/rotations.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {

std::vector<std::string> words_of_list(const std::string& list, const std::string& option) {
  std::vector<std::string> words(1);
  for (const char c : list) {
    if (c == ',') {
      words.emplace_back();
    } else if (c != ' ') {
      words.back() += c;
    }
  }
  for (const std::string& word : words) {
    if (!meaning_of_word(word)) throw InputError("Found \"" + word + "\" in " + option + "; expected " + meaning_words() + ", one a column.");
  }
  return words;
}

// What both kinds of files are told by the same options.
Profile stated_profile(const ImportArguments& a, const std::string& name, const std::string& columns, const std::string& option) {
  Profile profile;
  if (!name.empty()) profile = find_profile(name);
  if (!columns.empty()) {
    profile.columns = words_of_list(columns, option);
    profile.rename.clear();
  }
  if (!a.encoding.empty()) profile.encoding = a.encoding;
  if (!a.decimal.empty()) profile.decimal = a.decimal[0];
  if (!a.length_unit.empty()) profile.length_unit = a.length_unit;
  if (!a.angle_unit.empty()) profile.angle_unit = a.angle_unit;
  if (!a.joint_unit.empty()) profile.joint_unit = a.joint_unit;
  if (a.coverage > 0) profile.coverage = a.coverage;
  return profile;
}

}  // namespace

void add_import_options(CLI::App& command, ImportArguments& a) {
  command.add_option("--robot-log", a.log, "The robot's joints: a table, or a KRL, RAPID, LS, JBI, URScript, VAL3 or JointState file");
  command.add_option("--profile", a.profile, "Layout of the tracker's files: a built-in profile or a TOML file; default told from the file");
  command.add_option("--log-profile", a.log_profile, "Layout of the robot's file, likewise");
  command.add_option("--columns", a.columns, "What each column of the tracker's files is, such as id,x_mm,y_mm,z_mm; - for one not used");
  command.add_option("--log-columns", a.log_columns, "What each column of the robot's file is, such as id,q1_deg,...");
  command.add_option("--join", a.join, "By id, by order, by time, or told from the files")
      ->check(CLI::IsMember({"told", "id", "order", "time"}))
      ->capture_default_str();
  command.add_option("--clock-offset", a.clock_offset_s, "The tracker's clock is this much ahead of the robot's [s]")->capture_default_str();
  command.add_option("--max-gap", a.max_gap_s, "Largest distance in time between a point and its joints [s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command.add_option("--still", a.still_deg, "By time: a joint that changes more between rows moves [deg]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command.add_option("--targets", a.targets, "Names of the points of a row, or of the files, in order")->delimiter(',');
  command.add_option("--encoding", a.encoding, "Encoding of the files; default told")->check(CLI::IsMember({"utf-8", "utf-16", "latin-1"}));
  command.add_option("--decimal", a.decimal, "Decimal separator; default told")->check(CLI::IsMember({".", ","}));
  command.add_option("--length-unit", a.length_unit, "Unit of lengths that state none; default the robot file's")
      ->check(CLI::IsMember({"mm", "m", "um", "in"}));
  command.add_option("--angle-unit", a.angle_unit, "Unit of a rotation's angles that state none; default deg")->check(CLI::IsMember({"deg", "rad"}));
  command.add_option("--joint-unit", a.joint_unit, "Unit of joints that state none; default deg")->check(CLI::IsMember({"deg", "rad"}));
  command.add_option("--coverage", a.coverage, "Expanded uncertainties are this many standard deviations; default 2")->check(CLI::Range(0.1, 10.0));
  command.add_option("--pulses-per-degree", a.pulses_per_degree, "Of each joint, for a job that states pulses")->delimiter(',');
}

ImportOptions import_options(const ImportArguments& a) {
  ImportOptions options;
  options.exports = a.exports;
  options.log = a.log;
  options.profile = stated_profile(a, a.profile, a.columns, "--columns");
  options.log_profile = stated_profile(a, a.log_profile, a.log_columns, "--log-columns");
  if (!a.rotation.empty()) {
    if (a.rotation != "none") (void)require_rotation_convention(a.rotation, "--rotation");
    options.profile.rotation = a.rotation;
  }
  if (!a.targets.empty()) options.profile.targets = a.targets;
  options.join.by = a.join == "id" ? JoinBy::id : a.join == "order" ? JoinBy::order : a.join == "time" ? JoinBy::time : JoinBy::told;
  options.join.clock_offset_s = a.clock_offset_s;
  options.join.max_gap_s = a.max_gap_s;
  options.join.still_rad = a.still_deg * rad_per_deg;
  options.pulses_per_unit = a.pulses_per_degree;
  for (const double pulses : a.pulses_per_degree) {
    if (!(pulses > 0 || pulses < 0)) throw InputError("Found 0 in --pulses-per-degree; expected the pulses of one degree for each joint.");
  }
  return options;
}

Dataset read_imported(const ImportArguments& arguments, const Robot& robot) {
  const Imported imported = import_measurements(import_options(arguments), robot);
  Dataset data = parse_dataset(imported.text, arguments.exports.front(), robot);
  data.notes.insert(data.notes.begin(), imported.notes.begin(), imported.notes.end());
  return data;
}

}  // namespace mdhcal::offline
