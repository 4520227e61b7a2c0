// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <memory>

#include "offline/base/error.hpp"
#include "offline/cli/blob_command.hpp"
#include "offline/cli/commands.hpp"
#include "offline/filter/cold_start.hpp"

namespace mdhcal::offline {

namespace {

struct CorrectArguments {
  std::string blob, joints;
};

// The pose that a controller with the nominal geometry means by its joints, met by the arm as it is.
void run_correct(const CorrectArguments& arguments) {
  const BlobArm blob = read_blob_arm(arguments.blob, PoseOptions{});
  Geometry nominal = blob.model.geometry;
  std::copy(std::begin(blob.model.nominal), std::end(blob.model.nominal), nominal.link);
  Arm<double> nominal_arm{};
  if (make_arm(nominal, nominal_arm) != Status::ok) {
    throw InputError(arguments.blob, 0, 0, "The nominal geometry in the blob is outside the library's valid range.");
  }
  const Table<JointRow> table = read_joint_file(arguments.joints, nominal);
  inform_all(table.notes);
  std::string out = "id,status," + joint_header(nominal, "q") + '\n';
  for (const JointRow& row : table.rows) {
    Pose<double> meant{};
    Solved solved{row.q, forward(nominal_arm, row.q.data(), meant)};
    if (solved.status == Status::ok) solved = solve_from(blob.arm, meant, row.q);
    out += csv_field(row.id) + ',' + status_word(solved.status) + joint_fields(nominal, solved.q.data()) + '\n';
  }
  (void)std::fwrite(out.data(), 1, out.size(), stdout);
}

}  // namespace

void add_correct(CLI::App& app) {
  auto arguments = std::make_shared<CorrectArguments>();
  CLI::App* command = app.add_subcommand("correct", "Turn nominal joints into corrected joints that reach the pose meant");
  command->add_option("BLOB", arguments->blob, "Parameter blob")->required();
  command->add_option("JOINTS", arguments->joints, "Table (CSV) with q1..qN of the nominal robot")->required();
  command->footer("Example:\n  mdhcal correct result/calibration.blob program.csv > corrected.csv");
  command->callback([arguments] { run_correct(*arguments); });
}

}  // namespace mdhcal::offline
