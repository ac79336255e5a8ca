// Frames taken from one bus and not yet handled.
#pragma once

#include <array>

#include "drivers/can/can_bus.h"

namespace limber::sim {

/// Fetches in batches, hands out one by one, so that a caller who stops in the middle loses
/// nothing. Allowed in the cycle.
class Inbox {
 public:
  explicit Inbox(CanBus* bus) : bus_(bus) {}

  /// The next frame, or nullptr when none waits; valid until the next call.
  const CanFrame* next() noexcept {
    if (next_ == count_) {
      next_ = 0;
      count_ = bus_->receive(frames_);
    }
    return next_ < count_ ? &frames_[next_++] : nullptr;
  }

  CanBus* bus() const noexcept { return bus_; }

 private:
  CanBus* bus_;
  std::array<CanFrame, 16> frames_;
  int count_ = 0;
  int next_ = 0;
};

}  // namespace limber::sim
