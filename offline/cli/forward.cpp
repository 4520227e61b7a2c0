// SPDX-License-Identifier: MIT
#include <cstdio>
#include <memory>

#include "offline/base/error.hpp"
#include "offline/cli/blob_command.hpp"
#include "offline/cli/commands.hpp"
#include "offline/measure/joint_file.hpp"
#include "offline/robot/rotation.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {

struct ForwardArguments {
  std::string blob, joints;
  PoseOptions pose;
};

void run_forward(const ForwardArguments& arguments) {
  const BlobArm blob = read_blob_arm(arguments.blob, arguments.pose);
  const Table<JointRow> table = read_joint_file(arguments.joints, blob.model.geometry);
  inform_all(table.notes);
  std::string out = "id,x_mm,y_mm,z_mm,qw,qx,qy,qz\n";
  for (const JointRow& row : table.rows) {
    Pose<double> pose{};
    if (forward(blob.arm, row.q.data(), pose) != Status::ok) {
      throw InputError(arguments.joints, 0, 0, "Row " + row.id + ": a joint is outside the library's range.");
    }
    // The flange in the base frame is printed with the bits that the library computed.
    if (arguments.pose.frame != "base" || arguments.pose.has_target) pose = pose_of(blob.world_T_target(pose));
    out += csv_field(row.id);
    for (const double p : pose.position_m) out += ',' + csv_number(millimetre.from_si(p));
    for (const double c : pose.quaternion) out += ',' + csv_number(c);
    out += '\n';
  }
  (void)std::fwrite(out.data(), 1, out.size(), stdout);
}

}  // namespace

void add_forward(CLI::App& app) {
  auto arguments = std::make_shared<ForwardArguments>();
  CLI::App* command = app.add_subcommand("forward", "Print the poses of joints, as a controller with this blob computes them");
  command->add_option("BLOB", arguments->blob, "Parameter blob")->required();
  command->add_option("JOINTS", arguments->joints, "Table (CSV) with q1..qN, in degrees and millimetres unless a column "
                                                   "says otherwise")
      ->required();
  arguments->pose.add_to(*command);
  command->footer("Example:\n  mdhcal forward result/calibration.blob joints.csv > poses.csv");
  command->callback([arguments] { run_forward(*arguments); });
}

}  // namespace mdhcal::offline
