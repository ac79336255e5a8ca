// Frames that a node wants to send, in order; those that find no room are lost.
#pragma once

#include <array>
#include <cstddef>

#include "drivers/can/can_frame.h"

namespace limber::sim {

/// Allowed in the cycle throughout.
class FrameQueue {
 public:
  void push(const CanFrame& frame) noexcept {
    if (count_ == frames_.size()) return;
    frames_[(first_ + count_++) % frames_.size()] = frame;
  }
  bool pop(CanFrame* frame) noexcept {
    if (count_ == 0) return false;
    *frame = frames_[first_];
    first_ = (first_ + 1) % frames_.size();
    --count_;
    return true;
  }
  void clear() noexcept { count_ = 0; }

 private:
  std::array<CanFrame, 16> frames_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace limber::sim
