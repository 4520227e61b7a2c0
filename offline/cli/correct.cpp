// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <locale>
#include <memory>
#include <sstream>

#include "offline/base/error.hpp"
#include "offline/cli/blob_command.hpp"
#include "offline/cli/commands.hpp"
#include "offline/cli/rotation_option.hpp"
#include "offline/filter/cold_start.hpp"
#include "offline/measure/joint_file.hpp"
#include "offline/measure/rotations.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

struct CorrectArguments {
  std::string blob, joints;
  std::string as = "joints", rotation = "quaternion", tool, frame;
};

constexpr double degree_rad = 3.14159265358979323846 / 180;

bool in_degrees(const RotationConvention& convention) { return convention.form != RotationForm::quaternion; }

// x,y,z [mm] and a rotation in the convention ([deg], or a quaternion); the identity of an empty option.
Frame<double> frame_of_option(const std::string& option, const std::string& name, const RotationConvention& convention) {
  std::array<double, 7> number{0, 0, 0, 1};
  if (option.empty()) return frame_of({1, 0, 0, 0}, {0, 0, 0});
  const std::size_t count = 3 + convention.count();
  std::istringstream in(option);
  in.imbue(std::locale::classic());
  std::size_t read = 0;
  for (; read < count && in >> number[read]; ++read) {
    if (read + 1 < count && in.get() != ',') break;
  }
  if (read != count || in.peek() != std::istringstream::traits_type::eof()) {
    throw InputError("Found " + name + " \"" + option + "\"; expected " + std::to_string(count) +
                     " numbers with commas between them: x,y,z in mm and the rotation that --rotation names.");
  }
  std::array<double, 4> rotation{};
  for (std::size_t k = 0; k < convention.count(); ++k) rotation[k] = number[3 + k] * (in_degrees(convention) ? degree_rad : 1);
  return frame_of(quaternion_from(convention, rotation), {number[0] / 1e3, number[1] / 1e3, number[2] / 1e3});
}

// Poses for a controller that computes with the nominal geometry: where that geometry sees the corrected joints.
struct PosesToCommand {
  RotationConvention convention;
  Frame<double> frame, tool;

  std::string header() const {
    std::string out = "id,status,x_mm,y_mm,z_mm";
    if (convention.form == RotationForm::vector) return out + ",rx_deg,ry_deg,rz_deg\n";
    if (convention.form == RotationForm::euler) return out + ",e1_deg,e2_deg,e3_deg\n";
    return out + (convention.scalar_last ? ",q1,q2,q3,q4\n" : ",qw,qx,qy,qz\n");
  }

  std::string fields(const Pose<double>& base_T_flange) const {
    const Pose<double> pose = pose_of(compose(compose(inverted(frame), frame_of(base_T_flange)), tool));
    std::string out;
    for (const double p : pose.position_m) out += ',' + csv_number(1e3 * p);
    const std::array<double, 4> numbers = numbers_of(convention, {pose.quaternion[0], pose.quaternion[1], pose.quaternion[2], pose.quaternion[3]});
    for (std::size_t k = 0; k < convention.count(); ++k) out += ',' + csv_number(numbers[k] / (in_degrees(convention) ? degree_rad : 1));
    return out;
  }
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
  const bool poses = arguments.as == "poses";
  PosesToCommand command{require_rotation_convention(arguments.rotation, "--rotation"), {}, {}};
  command.frame = frame_of_option(arguments.frame, "--frame", command.convention);
  command.tool = frame_of_option(arguments.tool, "--tool", command.convention);
  std::string out = poses ? command.header() : "id,status," + joint_header(nominal, "q") + '\n';
  for (const JointRow& row : table.rows) {
    Pose<double> meant{};
    Solved solved{row.q, forward(nominal_arm, row.q.data(), meant)};
    if (solved.status == Status::ok) solved = solve_from(blob.arm, meant, row.q);
    Pose<double> told = meant;
    if (poses && solved.status == Status::ok) solved.status = forward(nominal_arm, solved.q.data(), told);
    out += csv_field(row.id) + ',' + status_word(solved.status) + (poses ? command.fields(told) : joint_fields(nominal, solved.q.data())) + '\n';
  }
  (void)std::fwrite(out.data(), 1, out.size(), stdout);
}

}  // namespace

void add_correct(CLI::App& app) {
  auto arguments = std::make_shared<CorrectArguments>();
  CLI::App* command = app.add_subcommand("correct", "Turn nominal joints into corrected joints that reach the pose meant");
  command->add_option("BLOB", arguments->blob, "Parameter blob")->required();
  command->add_option("JOINTS", arguments->joints, "Table (CSV) with q1..qN of the nominal robot")->required();
  command->add_option("--as", arguments->as, "What to print: corrected joints, or the poses with which a controller of the nominal geometry gets there")
      ->check(CLI::IsMember({"joints", "poses"}))
      ->capture_default_str();
  command->add_option("--tool", arguments->tool, "Tool of the poses in the flange frame: x,y,z [mm] and a rotation as --rotation says");
  command->add_option("--frame", arguments->frame, "Frame of the poses in the robot's base, likewise");
  add_rotation_option(*command, arguments->rotation);
  command->footer("Example:\n  mdhcal correct result/calibration.blob program.csv > corrected.csv");
  command->callback([arguments] { run_correct(*arguments); });
}

}  // namespace mdhcal::offline
