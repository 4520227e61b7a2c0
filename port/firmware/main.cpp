// SPDX-License-Identifier: MIT
// Example firmware: a 1 kHz servo loop that moves along a path as the calibrated arm needs it, and takes a new
// calibration while it runs. Options on the semihosting command line:
//   --serial S         accept blobs for this robot only
//   --allow-nominal    move with nominal joints where there is no acceptable blob
//   --ticks N          end after N milliseconds
//   --flash-read-fails, --cut-after N, --fail-after N    faults of the emulated flash, for tests
#include <cstdlib>
#include <cstring>

#include "board.hpp"
#include "emulated_flash.hpp"
#include "mdhcal/port/store.hpp"
#include "motion.hpp"
#include "receiver.hpp"
#include "ring.hpp"
#include "trace.hpp"

namespace {

using namespace firmware;
using mdhcal::Status;

Motion motion;
Receiver receiver;
Ring channel;
Correction corrections[2];
std::uint8_t blob[mdhcal::blob_size];
std::uint32_t worst_tick = 0;

struct Options {
  const char* serial = nullptr;
  bool allow_nominal = false;
  std::uint32_t ticks = 0;
};

// Where the loader puts what it accepts: a correction that the servo loop does not hold.
struct LoaderContext {
  const Options* options;
  Correction* target;
};

Status prepare(const std::uint8_t* bytes, std::size_t size, void* context) {
  const LoaderContext& loader = *static_cast<const LoaderContext*>(context);
  Correction& target = *loader.target;
  mdhcal::DecodeOptions demands;
  demands.serial = loader.options->serial;
  const Status status = mdhcal::load(bytes, size, demands, target.arm);
  if (mdhcal::usable(status) || status == Status::self_test_failed) {
    Line("self-test: ") << mdhcal::status_text(status);
  }
  if (!mdhcal::usable(status)) return status;
  if (target.arm.corrected.joint_count != joint_count) return Status::blob_value;
  const Status started = mdhcal::start_at_rest(target.arm, mdhcal::Model::corrected, target.compensator);
  if (started != Status::ok) return started;
  // The loop limits the steps of what it commands, which is between two corrections during a swap.
  target.options = mdhcal::default_tick_options(target.arm.corrected);
  return Status::ok;
}

// The correction that is neither active nor about to be.
Correction& spare() { return motion.active() == &corrections[0] ? corrections[1] : corrections[0]; }

void take_update(const mdhcal::Flash& flash, const Options& options, mdhcal::StoreState& state) {
  if (motion.swap() == Swap::running) {
    Line("update: refused, a swap is running");
    return;
  }
  LoaderContext context{&options, &spare()};
  const Status status = mdhcal::update(flash, {prepare, &context}, receiver.blob(), mdhcal::blob_size, state);
  if (status != Status::ok) {
    Line("update: refused, ") << mdhcal::status_text(status) << "; the active model stays";
    return;
  }
  Line("update: committed to slot ") << state.active << ", sequence " << state.sequence;
  motion.request(*context.target);
  motion.enable(options.allow_nominal);
}

void trace_motion(const char* begin) {
  __asm volatile("cpsid i" ::: "memory");
  const Motion::Report report = motion.report();
  const std::uint32_t tick = motion.ticks();
  __asm volatile("cpsie i" ::: "memory");
  Line line(begin);
  line << " " << tick << (motion.active() == nullptr ? " nominal" : " corrected") << " path";
  for (double q : report.path_q) line << " " << q;
  line << " command";
  for (double q : report.command_q) line << " " << q;
  line << " largest " << report.largest_step << " limited " << report.limited << " not-met " << report.not_met;
}

void trace_swap(Swap& last) {
  const Swap now = motion.swap();
  if (now == last) return;
  last = now;
  if (now == Swap::done) Line("swap: done");
  if (now == Swap::refused) {
    Line("swap: refused, joint ") << motion.refused_joint() + 1 << " would change by more than the bound; "
                                  << (motion.active() != nullptr ? "the active model stays"
                                      : motion.enabled()         ? "nominal joints, as the integrator allows"
                                                                 : "no motion");
  }
}

[[noreturn]] void end(std::uint32_t status) {
  trace_motion("end");
  Line("worst tick: ") << worst_tick << " of " << board::timer_hz / 1000U << " timer ticks";
  semihosting_exit(status);
}

void boot(const mdhcal::Flash& flash, const Options& options, mdhcal::StoreState& state) {
  LoaderContext context{&options, &corrections[0]};
  const Status status = mdhcal::load_newest(flash, {prepare, &context}, blob, state);
  for (std::uint32_t slot = 0; slot < 2; ++slot) {
    Line("boot: slot ") << slot << ": " << mdhcal::status_text(state.slot[slot]);
  }
  if (status == Status::ok) {
    Line("boot: slot ") << state.active << ", sequence " << state.sequence << ", robot "
                        << context.target->arm.description.name << ", serial " << context.target->arm.description.serial;
    motion.request(*context.target);
    motion.enable(options.allow_nominal);
  } else if (options.allow_nominal) {
    Line("boot: ") << mdhcal::status_text(status) << "; moving with nominal joints, as the integrator allows";
    motion.enable(true);
  } else {
    Line("boot: ") << mdhcal::status_text(status) << "; no motion";
  }
}

Options read_options(int count, char** arguments, EmulatedFlash& flash) {
  Options options;
  for (int i = 1; i < count; ++i) {
    const char* value = i + 1 < count ? arguments[i + 1] : "";
    if (std::strcmp(arguments[i], "--serial") == 0) options.serial = value;
    if (std::strcmp(arguments[i], "--ticks") == 0) options.ticks = static_cast<std::uint32_t>(std::atoi(value));
    if (std::strcmp(arguments[i], "--cut-after") == 0) flash.cut_after = static_cast<std::uint32_t>(std::atoi(value));
    if (std::strcmp(arguments[i], "--fail-after") == 0) flash.fail_after = static_cast<std::uint32_t>(std::atoi(value));
    if (std::strcmp(arguments[i], "--allow-nominal") == 0) options.allow_nominal = true;
    if (std::strcmp(arguments[i], "--flash-read-fails") == 0) flash.read_fails = true;
  }
  return options;
}

}  // namespace

extern "C" void timer0_handler() {
  board::acknowledge_timer();
  const std::uint32_t begin = board::until_interrupt();
  motion.tick();
  const std::uint32_t end_of_tick = board::until_interrupt();
  constexpr std::uint32_t period = board::timer_hz / 1000U;
  const std::uint32_t spent = begin >= end_of_tick ? begin - end_of_tick : begin + period - end_of_tick;
  if (spent > worst_tick) worst_tick = spent;
}

extern "C" void uart0_receive_handler() {
  std::uint8_t byte = 0;
  if (board::receive(byte)) channel.put(byte);
}

int main(int count, char** arguments) {
  static EmulatedFlash flash(board::flash_region);
  const Options options = read_options(count, arguments, flash);
  board::start_uart();
  mdhcal::StoreState state{};
  boot(flash.flash, options, state);
  board::start_timer(board::timer_hz / 1000U);

  Swap last_swap = Swap::none;
  std::uint32_t traced = 0;
  for (;;) {
    board::wait_for_interrupt();
    const std::uint32_t now_ms = motion.ticks();
    std::uint8_t byte = 0;
    Receiver::Event event = receiver.idle(now_ms);
    while (event == Receiver::Event::none && channel.take(byte)) event = receiver.take(byte, now_ms);
    if (event == Receiver::Event::blob) take_update(flash.flash, options, state);
    if (event == Receiver::Event::bad_size) Line("update: refused, ") << mdhcal::status_text(Status::blob_size);
    if (event == Receiver::Event::abandoned) {
      Line("update: abandoned after ") << receiver.received() << " bytes; the active model stays";
    }
    if (event == Receiver::Event::quit) end(0);
    trace_swap(last_swap);
    if (now_ms - traced >= 100U) {
      traced = now_ms;
      trace_motion("tick");
    }
    if (options.ticks != 0U && now_ms >= options.ticks) end(0);
  }
}
