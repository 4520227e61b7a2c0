// SPDX-License-Identifier: MIT
#include <time.h>

#include <cstdio>

#include <mdhcal/mdhcal.hpp>

using namespace mdhcal;
static CalibratedArm<double> arm;
static Compensator<double> loop;

int main(int, char** arguments) {
  static std::uint8_t bytes[blob_size];
  std::FILE* file = std::fopen(arguments[1], "rb");
  const std::size_t size = file != nullptr ? std::fread(bytes, 1, sizeof bytes, file) : 0;
  if (!usable(load(bytes, size, {}, arm)) || start_at_rest(arm, Model::corrected, loop) != Status::ok) return 1;
  const TickOptions<double> options = default_tick_options(arm, 0.001);
  double nominal_q[max_joints] = {0.5, 0.4, 0.6, 0.5, 0.7, 0.5}, q[max_joints] = {0.5, 0.4, 0.6, 0.5, 0.7, 0.5};
  constexpr timespec millisecond{0, 1000000};
  for (int tick = 0; tick < 1000; ++tick) {
    nanosleep(&millisecond, nullptr);
    nominal_q[0] += 0.0001;                                                // what your controller's own inverse gives
    if (!usable(joints_to_joints(loop, options, nominal_q, q))) return 2;  // q: what to command in its place
  }
  return std::printf("joint 1 at %.6f rad\n", q[0]) > 0 ? 0 : 3;
}
