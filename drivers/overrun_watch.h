// Counts cycles that took longer than their period.
#pragma once

#include <cstdint>

#include "drivers/gate/event_window.h"

namespace limber {

/// Allowed inside the cycle.
class OverrunWatch {
 public:
  explicit OverrunWatch(std::int64_t cycles_per_second) : cycles_per_second_(cycles_per_second) {}

  /// Once a cycle; true if it is the third overrun in a row, or the tenth within a second.
  bool too_many(bool overrun) noexcept {
    ++cycle_;
    in_a_row_ = overrun ? in_a_row_ + 1 : 0;
    if (!overrun) return false;
    ++count_;
    const bool often = window_.add(cycle_, cycles_per_second_);
    return often || in_a_row_ >= 3;
  }
  std::int64_t count() const noexcept { return count_; }

 private:
  std::int64_t cycles_per_second_;
  std::int64_t cycle_ = 0;
  std::int64_t count_ = 0;
  int in_a_row_ = 0;
  EventWindow<10> window_;
};

}  // namespace limber
