// Counts cycles that took longer than their period; b in a row are bridged (two on a wire).
#pragma once

#include <cstdint>

#include "drivers/gate/event_window.h"

namespace limber {

/// Allowed inside the cycle.
class OverrunWatch {
 public:
  explicit OverrunWatch(std::int64_t cycles_per_second, int bridged_cycles = 2)
      : span_(2 * cycles_per_second / bridged_cycles), bridged_(bridged_cycles) {}

  /// Once a cycle; true if one more than bridged is an overrun in a row, or it is the tenth within 2/b seconds.
  bool too_many(bool overrun) noexcept {
    ++cycle_;
    in_a_row_ = overrun ? in_a_row_ + 1 : 0;
    if (!overrun) return false;
    ++count_;
    const bool often = window_.add(cycle_, span_);
    return often || in_a_row_ > bridged_;
  }
  std::int64_t count() const noexcept { return count_; }

 private:
  std::int64_t span_;
  int bridged_;
  std::int64_t cycle_ = 0;
  std::int64_t count_ = 0;
  int in_a_row_ = 0;
  EventWindow<10> window_;
};

}  // namespace limber
