// Simulated time, in whole integration steps, and the arm time that it stands for.
#pragma once

#include <cmath>
#include <cstdint>

namespace limber::sim {

/// Allowed in the cycle throughout.
class SimClock {
 public:
  SimClock(double rate_hz, std::int64_t steps_per_period)
      : period_ns_(std::llround(1e9 * (1.0 / rate_hz))),
        steps_per_period_(steps_per_period),
        step_s_(1.0 / rate_hz / static_cast<double>(steps_per_period)) {}

  void advance() noexcept { ++steps_; }

  double step_s() const noexcept { return step_s_; }
  std::int64_t steps_per_period() const noexcept { return steps_per_period_; }
  std::int64_t period_ns() const noexcept { return period_ns_; }
  /// Control periods completed.
  std::int64_t periods() const noexcept { return steps_ / steps_per_period_; }
  /// Since construction; now and at the end of the next step.
  std::int64_t now_ns() const noexcept { return time_ns(steps_); }
  std::int64_t next_ns() const noexcept { return time_ns(steps_ + 1); }

  /// The arm time that it is now.
  void set_arm_time_ns(std::int64_t time_ns) noexcept {
    arm_time_known_ = true;
    arm_offset_ns_ = time_ns - now_ns();
  }
  bool arm_time_known() const noexcept { return arm_time_known_; }
  std::int64_t arm_time_ns() const noexcept { return now_ns() + arm_offset_ns_; }

 private:
  std::int64_t time_ns(std::int64_t steps) const noexcept {
    return steps / steps_per_period_ * period_ns_ +
           steps % steps_per_period_ * period_ns_ / steps_per_period_;
  }

  std::int64_t period_ns_;
  std::int64_t steps_per_period_;
  double step_s_;
  std::int64_t steps_ = 0;
  bool arm_time_known_ = false;
  std::int64_t arm_offset_ns_ = 0;
};

}  // namespace limber::sim
