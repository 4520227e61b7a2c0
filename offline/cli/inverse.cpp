// SPDX-License-Identifier: MIT
#include <cstdio>
#include <memory>

#include "offline/cli/blob_command.hpp"
#include "offline/cli/commands.hpp"
#include "offline/cli/rotation_option.hpp"
#include "offline/filter/cold_start.hpp"
#include "offline/measure/joint_file.hpp"

namespace mdhcal::offline {

namespace {

struct InverseArguments {
  std::string blob, poses, rotation;
  PoseOptions pose;
  bool all = false;
};

void append(std::string& out, const Geometry& geometry, const std::string& id, const Solved& solved) {
  out += csv_field(id) + ',' + status_word(solved.status) + joint_fields(geometry, solved.q.data()) + '\n';
}

void run_inverse(const InverseArguments& arguments) {
  const BlobArm blob = read_blob_arm(arguments.blob, arguments.pose);
  const Geometry& geometry = blob.model.geometry;
  const Table<PoseRow> table = read_pose_file(arguments.poses, geometry, arguments.rotation);
  inform_all(table.notes);
  std::string out = "id,status," + joint_header(geometry, "q") + '\n';
  for (const PoseRow& row : table.rows) {
    const bool plain = arguments.pose.frame == "base" && !arguments.pose.has_target;
    const Pose<double> pose = plain ? row.pose : blob.base_T_flange(row.pose);
    if (arguments.all) {
      const std::vector<Solved> all = solve_all(blob.arm, pose);
      for (const Solved& solved : all) append(out, geometry, row.id, solved);
      if (!all.empty()) continue;
    }
    append(out, geometry, row.id, row.seed ? solve_near(blob.arm, pose, *row.seed) : solve_anew(blob.arm, pose));
  }
  (void)std::fwrite(out.data(), 1, out.size(), stdout);
}

}  // namespace

void add_inverse(CLI::App& app) {
  auto arguments = std::make_shared<InverseArguments>();
  CLI::App* command = app.add_subcommand("inverse", "Print the joints of poses, as a controller with this blob computes them");
  command->add_option("BLOB", arguments->blob, "Parameter blob")->required();
  command->add_option("POSES", arguments->poses, "Table (CSV) with x,y,z and qw,qx,qy,qz or rx,ry,rz, and optionally the "
                                                 "joints s1..sN to start from")
      ->required();
  command->add_flag("--all", arguments->all, "Every solution, a row each");
  arguments->pose.add_to(*command);
  add_rotation_option(*command, arguments->rotation);
  command->footer("Example:\n  mdhcal inverse result/calibration.blob poses.csv > joints.csv");
  command->callback([arguments] { run_inverse(*arguments); });
}

}  // namespace mdhcal::offline
