// SPDX-License-Identifier: MIT
// A new calibration while the loop runs: loaded beside it, handed over by an atomic pointer, taken over by a ramp.
//   swap_calibration OLD.blob NEW.blob
#include <atomic>
#include <cstdio>

#include "mdhcal/mdhcal.hpp"

namespace {

using namespace mdhcal;

std::atomic<const CalibratedArm<double>*> handed_over{nullptr};

bool load_file(const char* path, CalibratedArm<double>& arm) {
  static std::uint8_t bytes[blob_size];
  std::FILE* file = std::fopen(path, "rb");
  if (file == nullptr) return false;
  const std::size_t size = std::fread(bytes, 1, sizeof bytes, file);
  std::fclose(file);
  return usable(load(bytes, size, {}, arm));
}

}  // namespace

int main(int count, char** arguments) {
  static CalibratedArm<double> arms[2];
  if (count != 3 || !load_file(arguments[1], arms[0])) return 1;
  static Compensator<double> loop;
  if (start_at_rest(arms[0], Model::corrected, loop) != Status::ok) return 1;
  const TickOptions<double> options = default_tick_options(arms[0], 0.001);
  const double nominal_q[max_joints] = {0.5, 0.4, 0.6, 0.5, 0.7, 0.5, 0.5, 0.5};
  double q[max_joints] = {0.5, 0.4, 0.6, 0.5, 0.7, 0.5, 0.5, 0.5};

  for (int tick = 0; tick < 1000; ++tick) {
    // What a task of lower priority does meanwhile, at a time of its own.
    if (tick == 100 && load_file(arguments[2], arms[1])) handed_over.store(&arms[1]);
    // The compensator belongs to the loop; start_ramp() copies, so that the other task may reuse the arm afterwards.
    if (const CalibratedArm<double>* next = handed_over.exchange(nullptr)) {
      if (start_ramp(loop, *next, Model::corrected, 400) != Status::ok) std::printf("refused: another robot\n");
    }
    if (advance_ramp(loop) != Status::ok || !usable(joints_to_joints(loop, options, nominal_q, q))) return 1;
    if (tick % 200 == 199) std::printf("tick %d: joint 1 %.6f rad, %u ticks left\n", tick, q[0], ramp_ticks_left(loop));
  }
  return 0;
}
