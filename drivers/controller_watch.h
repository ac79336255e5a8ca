// Watchdog on the controller's answers: b cycles without an accepted command are bridged.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limber/driver_status_t.hpp>

namespace limber {

/// Allowed in the cycle.
class ControllerWatch {
 public:
  explicit ControllerWatch(int bridged_cycles) : bridged_cycles_(bridged_cycles) {}

  /// The gate has judged a command: VERDICT_* of driver_status_t.
  void note(int verdict) noexcept {
    ++verdicts_[static_cast<std::size_t>(verdict)];
    if (verdict == driver_status_t::VERDICT_ACCEPTED) answered_ = true;
  }
  /// Start of the next cycle. `leased`: some controller has the arm, so a missing answer counts.
  void next_cycle(bool leased) noexcept {
    silent_cycles_ = answered_ ? 0 : silent_cycles_ + 1;
    if (!answered_ && leased) ++missing_;
    answered_ = false;
  }
  bool lost() const noexcept { return silent_cycles_ > bridged_cycles_; }

  void write_status(driver_status_t* status) const noexcept {
    std::copy(verdicts_.begin(), verdicts_.end(), status->commands_refused);
    status->commands_refused[driver_status_t::VERDICT_ACCEPTED] = 0;
    status->commands_accepted = verdicts_[driver_status_t::VERDICT_ACCEPTED];
    status->commands_missing = missing_;
  }

 private:
  int bridged_cycles_;
  bool answered_ = false;  ///< a command was accepted since the cycle began
  std::int64_t silent_cycles_ = 0;
  std::int64_t missing_ = 0;
  std::array<std::int64_t, 16> verdicts_{};  ///< by VERDICT_*
};

}  // namespace limber
