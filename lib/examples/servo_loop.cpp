// SPDX-License-Identifier: MIT
// A servo loop in C++: load a blob, check it, follow a path with the arm as it is.
//   servo_loop BLOB
#include <cmath>
#include <cstdio>

#include "mdhcal/mdhcal.hpp"

int main(int count, char** arguments) {
  static std::uint8_t bytes[mdhcal::blob_size];
  std::FILE* file = count == 2 ? std::fopen(arguments[1], "rb") : nullptr;
  const std::size_t size = file != nullptr ? std::fread(bytes, 1, sizeof bytes, file) : 0;
  if (file != nullptr) std::fclose(file);

  // Once: decode, check, self-test. Here is also where serial, signature and counter are asked for: DecodeOptions.
  static mdhcal::CalibratedArm<double> arm;
  const mdhcal::Status loaded = mdhcal::load(bytes, size, {}, arm);
  std::printf("%s: %s\n", arm.description.name, mdhcal::status_text(loaded));
  if (!mdhcal::usable(loaded)) return 1;

  // One compensator a loop, at rest on the corrected geometry.
  static mdhcal::Compensator<double> loop;
  if (mdhcal::start_at_rest(arm, mdhcal::Model::corrected, loop) != mdhcal::Status::ok) return 1;
  const mdhcal::TickOptions<double> options = mdhcal::default_tick_options(arm, 0.001);

  // Every millisecond: the controller's joints in, the joints to command out.
  double command_q[mdhcal::max_joints] = {};
  for (int tick = 0; tick < 1000; ++tick) {
    double nominal_q[mdhcal::max_joints] = {};
    for (int i = 0; i < arm.nominal.joint_count; ++i) nominal_q[i] = 0.5 + 0.2 * std::sin(0.001 * tick + i);
    if (tick == 0) {
      for (int i = 0; i < arm.nominal.joint_count; ++i) command_q[i] = nominal_q[i];
    }
    const mdhcal::Status status = mdhcal::joints_to_joints(loop, options, nominal_q, command_q);
    if (!mdhcal::usable(status)) return 1;  // stop the drives; any other status keeps every limit
    if (tick % 250 == 249) std::printf("tick %d: joint 1 %.6f rad, %s\n", tick, command_q[0], mdhcal::status_text(status));
  }
  return 0;
}
