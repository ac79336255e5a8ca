// Real-time scheduling: what a process requests of the kernel, and what was granted.
#pragma once

#include <cstdint>
#include <string>

namespace limber {

struct RealtimeGrant {
  bool fifo = false;
  bool locked_memory = false;
  std::string reason;  ///< why not, empty if all was granted
};

/// SCHED_FIFO at `priority` (1..99) and locked memory, where permitted; timer slack 1 ns in any
/// case. Set-up only.
RealtimeGrant ask_for_realtime(int priority);

/// For processes in lock step, whose handovers otherwise wait for every busy program of the
/// machine. A run that sleeps between its cycles (`paced`): the lowest real-time priority where
/// that is permitted, which counts against every session; else nice -15, which counts within its
/// own where the kernel groups by session. Timer slack 1 ns in any case. Of the calling thread and
/// those that it starts. Returns why not, "" if granted. Set-up only.
std::string raise_priority(bool paced);

/// Until the absolute CLOCK_MONOTONIC time. Allowed in the cycle.
void sleep_until(std::int64_t time_ns) noexcept;

/// Absolute deadlines on CLOCK_MONOTONIC at a fixed period. Sleeps until `spin_ns` before each
/// deadline and spins the rest.
class PeriodicLoop {
 public:
  static constexpr std::int64_t kSpin_ns = 80'000;  ///< the driver's; sleeping is 10 to 50 us late

  PeriodicLoop(std::int64_t period_ns, std::int64_t spin_ns)
      : period_ns_(period_ns), spin_ns_(spin_ns) {}

  /// First deadline: one period from now.
  void start() noexcept;
  /// Waits for the deadline; returns how late it is, ns. Deadlines that have passed altogether are
  /// skipped, not caught up: a hiccup must not cause a burst of commands.
  std::int64_t wait() noexcept;
  /// The next deadline.
  std::int64_t deadline_ns() const noexcept { return deadline_ns_; }

 private:
  std::int64_t period_ns_;
  std::int64_t spin_ns_;
  std::int64_t deadline_ns_ = 0;
};

}  // namespace limber
