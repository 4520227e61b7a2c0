// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>

#include "mdhcal/compensator.hpp"

namespace firmware {

/// A calibration made ready for the servo loop. Constant while the loop may hold its pointer.
struct Correction {
  mdhcal::CalibratedArm<double> arm;
  mdhcal::Compensator<double> compensator;  ///< at rest on the corrected geometry
  mdhcal::TickOptions<double> options;
};

/// No joint moves further in one tick [rad] or [m].
inline constexpr double max_step = 0.00314;
/// A swap that would change a joint by more is refused [rad] or [m].
inline constexpr double max_jump = 0.02;
/// From one model to another [ticks].
inline constexpr std::uint32_t ramp_ticks = 400;
inline constexpr std::int32_t joint_count = 6;

/// What became of the last swap that was asked for.
enum class Swap : std::int32_t { none, running, done, refused };

/// The servo loop. tick() runs in the timer's interrupt; everything else in the background, which the interrupt may
/// break into anywhere but which never breaks into the interrupt: one pointer each way is all that they share.
class Motion {
 public:
  /// Lets the loop run along the path. Where there is no model, because its swap was refused, it moves with nominal
  /// joints if that is allowed, and is disabled again if not.
  void enable(bool nominal_allowed) {
    nominal_allowed_.store(nominal_allowed);
    enabled_.store(true);
  }
  bool enabled() const { return enabled_.load(); }
  /// Asks for a swap at the next tick. The correction must stay as it is until another is active.
  void request(const Correction& next) {
    swap_.store(Swap::running);
    requested_.store(&next);
  }
  Swap swap() const { return swap_.load(); }
  const Correction* active() const { return active_.load(); }
  std::int32_t refused_joint() const { return refused_joint_; }

  /// One millisecond.
  void tick();

  std::uint32_t ticks() const { return ticks_.load(); }

  /// What the last tick did; read with the interrupt held off.
  struct Report {
    double path_q[joint_count];     ///< nominal joints of the path [rad]
    double command_q[joint_count];  ///< what went to the drives [rad]
    double largest_step;            ///< largest |dq| since the start [rad]
    std::uint32_t limited;          ///< ticks that the step limit held back
    std::uint32_t not_met;          ///< ticks whose pose was not met, or whose joints were held
  };
  const Report& report() const { return report_; }

 private:
  bool begin_swap(const Correction& next);

  std::atomic<bool> enabled_{false};
  std::atomic<bool> nominal_allowed_{false};
  std::atomic<const Correction*> requested_{nullptr};
  std::atomic<const Correction*> active_{nullptr};
  std::atomic<Swap> swap_{Swap::none};
  std::atomic<std::uint32_t> ticks_{0};
  const Correction* next_ = nullptr;
  std::uint32_t ramp_ = 0;
  std::uint32_t path_ticks_ = 0;
  std::int32_t refused_joint_ = 0;
  double active_q_[joint_count] = {};
  double next_q_[joint_count] = {};
  Report report_ = {};
};

}  // namespace firmware
