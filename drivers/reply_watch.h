// Watchdog on one joint's replies: two cycles without one are bridged, the third in a row or the
// tenth within a second is too much.
#pragma once

#include <cstdint>

#include "drivers/gate/event_window.h"

namespace limber {

/// Allowed inside the cycle.
class ReplyWatch {
 public:
  explicit ReplyWatch(int cycles_per_second) : cycles_per_second_(cycles_per_second) {}

  /// Once a cycle, when it is over.
  void close_cycle(bool answered, std::int64_t cycle) noexcept {
    missing_ = answered ? 0 : missing_ + 1;
    if (!answered && losses_.add(cycle, cycles_per_second_)) lost_ = true;
    if (silent()) lost_ = true;
  }

  /// No reply in the last three cycles.
  bool silent() const noexcept { return missing_ >= 3; }
  /// Too many were missing at some time since reset(): the joint's angle is not to be built on.
  bool lost() const noexcept { return lost_; }
  void reset() noexcept {
    missing_ = 0;
    lost_ = false;
    losses_.clear();
  }

 private:
  int cycles_per_second_;
  int missing_ = 0;
  bool lost_ = false;
  EventWindow<10> losses_;
};

}  // namespace limber
