// Lock step at the pace of a clock: when a cycle may begin, and how far the run falls behind.
#pragma once

#include <cstdint>
#include <optional>

namespace limber {

/// A cycle is due one period after the one before it was. A run that is late catches up by
/// kMostCatchUp_ns at the most; beyond that simulated time has waited, and the schedule begins
/// anew. Nothing that is simulated sees any of it. Time is CLOCK_MONOTONIC, ns; allowed in the
/// cycle.
class Pacer {
 public:
  static constexpr std::int64_t kMostCatchUp_ns = 50'000'000;
  /// Slower than this share of real time a run counts as behind, judged over so long.
  static constexpr double kBehind = 0.9;
  static constexpr std::int64_t kWindow_ns = 3'000'000'000;

  explicit Pacer(std::int64_t period_ns) noexcept : period_ns_(period_ns) {}

  /// Once before each cycle: when it is due. A time that has passed: at once.
  std::int64_t next_due_ns(std::int64_t now_ns) noexcept {
    if (cycles_++ == 0) {
      first_ns_ = window_start_ns_ = due_ns_ = now_ns;
      return due_ns_;
    }
    due_ns_ += period_ns_;
    if (now_ns - due_ns_ > kMostCatchUp_ns) due_ns_ = now_ns;
    return due_ns_;
  }

  /// Once after next_due_ns(): the share of real time since the last window began, once a window
  /// in which the run was behind.
  std::optional<double> behind(std::int64_t now_ns) noexcept {
    const std::int64_t wall_ns = now_ns - window_start_ns_;
    if (wall_ns < kWindow_ns) return {};
    const std::int64_t arm_ns = (cycles_ - window_cycle_) * period_ns_;
    window_start_ns_ = now_ns;
    window_cycle_ = cycles_;
    const double share = static_cast<double>(arm_ns) / static_cast<double>(wall_ns);
    if (share >= kBehind) return {};
    return share;
  }

  /// Of the whole run: simulated seconds in a second of the clock.
  double share(std::int64_t now_ns) const noexcept {
    const std::int64_t wall_ns = now_ns - first_ns_;
    return wall_ns > 0 && cycles_ > 0
               ? static_cast<double>(cycles_ * period_ns_) / static_cast<double>(wall_ns)
               : 1.0;
  }

 private:
  std::int64_t period_ns_;
  std::int64_t cycles_ = 0;
  std::int64_t due_ns_ = 0;
  std::int64_t first_ns_ = 0;
  std::int64_t window_start_ns_ = 0;
  std::int64_t window_cycle_ = 0;
};

}  // namespace limber
