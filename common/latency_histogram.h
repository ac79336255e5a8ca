// Counts durations in logarithmic bins; adding is allocation-free.
#pragma once

#include <array>
#include <cstdint>

namespace limber {

/// Sixteen bins an octave from 1 ns on: a quantile is right to 5 %.
class LatencyHistogram {
 public:
  /// Negative durations count as 0. Allowed inside the cycle.
  void add(std::int64_t duration_ns) noexcept;
  /// Upper edge of the bin that holds the quantile (0..1), ns; 0 when empty.
  std::int64_t quantile(double q) const noexcept;
  std::int64_t max() const noexcept { return max_; }
  std::int64_t count() const noexcept { return count_; }

 private:
  static constexpr int kPerOctave = 16;
  std::array<std::int64_t, 40 * kPerOctave> bins_{};
  std::int64_t count_ = 0;
  std::int64_t max_ = 0;
};

}  // namespace limber
