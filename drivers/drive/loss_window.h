// The counting part of a watchdog: how many losses there were within a second.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace limber {

/// Remembers the last 5 b losses, where b in a row are bridged: ten for two on a wire. Allowed in
/// the cycle: everything but the constructor.
class LossWindow {
 public:
  explicit LossWindow(int bridged_cycles)
      : cycles_(5 * static_cast<std::size_t>(std::max(bridged_cycles, 1))) {}

  /// Notes a loss; true if it is the 5 b-th within `span` cycles, this one included. Cycles must
  /// not decrease.
  bool add(std::int64_t cycle, std::int64_t span) noexcept {
    cycles_[next_] = cycle;
    next_ = (next_ + 1) % cycles_.size();
    if (count_ < cycles_.size()) ++count_;
    return count_ == cycles_.size() && cycle - cycles_[next_] < span;
  }
  /// The loss noted last was none.
  void undo() noexcept {
    if (count_ == 0) return;
    next_ = (next_ + cycles_.size() - 1) % cycles_.size();
    --count_;
  }
  void clear() noexcept { count_ = next_ = 0; }

 private:
  std::vector<std::int64_t> cycles_;  ///< ring
  std::size_t next_ = 0;              ///< the oldest once the ring is full
  std::size_t count_ = 0;
};

}  // namespace limber
