// Two clocks read at one moment, on a machine that may stand still between the two.
#pragma once

#include <cstdint>
#include <limits>

namespace limber {

struct ClockPair {
  std::int64_t monotonic_ns;
  std::int64_t other_ns;
};

/// `monotonic` and `other` read ns. After a pause between them both are read again; what is left of
/// one makes `monotonic_ns` later than it should be, never earlier. Allowed inside the cycle.
template <typename Monotonic, typename Other>
ClockPair read_together(Monotonic monotonic, Other other) noexcept {
  constexpr int kAttempts = 4;
  constexpr std::int64_t kTogether_ns = 20'000;
  ClockPair best{};
  std::int64_t shortest_ns = std::numeric_limits<std::int64_t>::max();
  for (int i = 0; i < kAttempts && shortest_ns > kTogether_ns; ++i) {
    const std::int64_t before_ns = monotonic();
    const std::int64_t other_ns = other();
    const std::int64_t after_ns = monotonic();
    if (after_ns - before_ns >= shortest_ns) continue;
    shortest_ns = after_ns - before_ns;
    best = {after_ns, other_ns};
  }
  return best;
}

}  // namespace limber
