// Counts cycles that took longer than their period; b in a row are bridged (two on a wire).
#pragma once

#include <cstdint>

#include "drivers/drive/loss_window.h"

namespace limber {

/// Allowed inside the cycle.
class OverrunWatch {
 public:
  explicit OverrunWatch(std::int64_t cycles_per_second, int bridged_cycles = 2)
      : cycles_per_second_(cycles_per_second), bridged_(bridged_cycles), window_(bridged_cycles) {}

  /// Once a cycle; true if one more than bridged is an overrun in a row, or 5 b were within a
  /// second.
  bool too_many(bool overrun) noexcept {
    ++cycle_;
    in_a_row_ = overrun ? in_a_row_ + 1 : 0;
    if (!overrun) return false;
    ++count_;
    const bool often = window_.add(cycle_, cycles_per_second_);
    return often || in_a_row_ > bridged_;
  }
  std::int64_t count() const noexcept { return count_; }

 private:
  std::int64_t cycles_per_second_;
  int bridged_;
  std::int64_t cycle_ = 0;
  std::int64_t count_ = 0;
  int in_a_row_ = 0;
  LossWindow window_;
};

}  // namespace limber
