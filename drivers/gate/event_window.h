// "N times within a while": the memory of a counting watchdog.
#pragma once

#include <array>
#include <cstdint>

namespace limber {

/// Remembers when the last N events were, in cycles. Allowed inside the cycle.
template <int N>
class EventWindow {
 public:
  /// Notes one event in this cycle; true if it is the Nth within `span` cycles, the present one
  /// included. Cycles must not decrease.
  bool add(std::int64_t cycle, std::int64_t span) noexcept {
    at_[next_] = cycle;
    next_ = (next_ + 1) % N;
    if (count_ < N) ++count_;
    return count_ == N && cycle - at_[next_] < span;
  }
  void clear() noexcept { count_ = next_ = 0; }

 private:
  std::array<std::int64_t, N> at_{};
  int next_ = 0;  ///< oldest entry once the ring is full
  int count_ = 0;
};

}  // namespace limber
