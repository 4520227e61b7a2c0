// SPDX-License-Identifier: MIT
// A calibrated arm on Zephyr: the newest blob of the flash partition, and a second of a loop at 1 kHz. The first blob comes by
// `mdhcal export calibration.blob --slot --sequence 1 --format hex --address <of the partition> -o slot0.hex`.
#include <zephyr/kernel.h>
#include <zephyr/storage/flash_map.h>

#include <mdhcal/mdhcal.hpp>
#include <mdhcal/port/store.hpp>
#include <mdhcal/port/zephyr_flash.hpp>

namespace {

using namespace mdhcal;

CalibratedArm<double> arm;
Compensator<double> loop;
ZephyrFlash partition;
StoreState state;
std::uint8_t blob[blob_size];

// Judges a blob of the store, and takes it. Here also another library's bits, within the tolerance, are good enough.
Status prepare(const std::uint8_t* bytes, std::size_t size, void* context) {
  const Status status = load(bytes, size, {}, *static_cast<CalibratedArm<double>*>(context));
  return usable(status) ? Status::ok : status;
}

}  // namespace

K_TIMER_DEFINE(period, nullptr, nullptr);

int main() {
  Status status = open_zephyr_flash(FIXED_PARTITION_ID(storage_partition), partition);
  if (status == Status::ok) status = load_newest(partition.flash, {prepare, &arm}, blob, state);
  printk("%s: %s\n", arm.description.name, status_text(status));
  if (status != Status::ok || start_at_rest(arm, Model::corrected, loop) != Status::ok) return 1;

  const TickOptions<double> options = default_tick_options(arm, 0.001);
  double nominal_q[max_joints] = {0.5, 0.4, 0.6, 0.5, 0.7, 0.5, 0.5, 0.5};
  double q[max_joints] = {0.5, 0.4, 0.6, 0.5, 0.7, 0.5, 0.5, 0.5};
  k_timer_start(&period, K_MSEC(1), K_MSEC(1));
  for (int tick = 0; tick < 1000; ++tick) {
    k_timer_status_sync(&period);
    nominal_q[0] += 0.0001;
    status = joints_to_joints(loop, options, nominal_q, q);
    if (!usable(status)) return 1;  // stop the drives; any other status keeps every limit
  }
  printk("1000 ticks, joint 1 moved to %d urad: %s\n", static_cast<int>(q[0] * 1e6), status_text(status));
  return 0;
}
