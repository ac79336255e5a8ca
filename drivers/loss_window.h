// "Ten within a second", for a tolerance of two in a row; as much more for a greater one.
#pragma once

#include <algorithm>
#include <cstdint>

#include "drivers/gate/event_window.h"

namespace limber {

/// Counts losses where b in a row are bridged: 5 b within a span are too many. Only each (b/2)th is
/// remembered, so that the memory has the same length for every b. Allowed inside the cycle.
class LossWindow {
 public:
  explicit LossWindow(int bridged_cycles) : stride_(std::max(bridged_cycles / 2, 1)) {}

  bool add(std::int64_t cycle, std::int64_t span) noexcept {
    if (++losses_ % stride_ != 0) return false;
    return window_.add(cycle, span);
  }
  void clear() noexcept {
    losses_ = 0;
    window_.clear();
  }

 private:
  int stride_;
  std::int64_t losses_ = 0;
  EventWindow<10> window_;
};

}  // namespace limber
