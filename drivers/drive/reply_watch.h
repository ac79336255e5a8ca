// Watchdog on one joint's replies: b cycles without one are bridged (two on a wire). One more in a
// row is too much, and so are 5 b within a second. A reply that comes in the next cycle is late,
// not lost.
#pragma once

#include <cstdint>

#include "drivers/drive/loss_window.h"

namespace limber {

/// Allowed inside the cycle.
class ReplyWatch {
 public:
  ReplyWatch(int cycles_per_second, int bridged_cycles)
      : cycles_per_second_(cycles_per_second), bridged_(bridged_cycles), losses_(bridged_cycles) {}

  /// Once a cycle, when it is over.
  void close_cycle(bool answered, std::int64_t cycle) noexcept {
    missing_ = answered ? 0 : missing_ + 1;
    answered_ = answered ? answered_ + 1 : 0;
    const bool often = !answered && losses_.add(cycle, cycles_per_second_);
    if (often || missing_ > bridged_) lost_ = true;
  }

  /// The reply of the cycle closed last has come after all.
  void came_late() noexcept {
    if (missing_ == 0) return;
    missing_ = 0;
    losses_.undo();
  }

  /// Cycles without a reply up to now.
  std::int64_t missing() const noexcept { return missing_; }
  /// Too many were missing at some time since reset().
  bool lost() const noexcept { return lost_; }
  /// The joint's angle is good to be held at: never lost, or back for 50 ms without a gap.
  bool trusted() const noexcept { return !lost_ || 20 * answered_ >= cycles_per_second_; }
  void reset() noexcept {
    missing_ = 0;
    lost_ = false;
    losses_.clear();
  }

 private:
  int cycles_per_second_;
  int bridged_;
  std::int64_t missing_ = 0;
  std::int64_t answered_ = 0;
  bool lost_ = false;
  LossWindow losses_;
};

}  // namespace limber
