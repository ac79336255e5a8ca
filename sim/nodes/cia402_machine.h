// The state machine of an emulated CiA 402 drive: what commands do to it, and what it does by
// itself.
#pragma once

#include <cstdint>

#include "drivers/protocols/cia402.h"

namespace limber::sim {

/// Allowed in the cycle throughout.
class Cia402Machine {
 public:
  /// Works a controlword through. With `reset_allowed` false a fault stays. Quick stop option as in
  /// 605Ah: 0 switches off at once, 1 to 4 when the joint stands, 5 to 8 stay in quick stop.
  void on_controlword(std::uint16_t controlword, int quick_stop_option,
                      bool reset_allowed) noexcept;
  /// Switched on or enabled: as the controlword does.
  void quick_stop(int quick_stop_option) noexcept;
  void disable_voltage() noexcept;
  /// Any state: fault reaction, then fault.
  void fail(std::int64_t now_ns) noexcept;
  /// The transitions that no command makes: start, end of a quick stop, end of the fault reaction.
  void update(std::int64_t now_ns, bool standing, int quick_stop_option) noexcept;
  void reset() noexcept { *this = {}; }

  cia402::State state() const noexcept { return state_; }
  bool failed() const noexcept {
    return state_ == cia402::State::kFaultReactionActive || state_ == cia402::State::kFault;
  }

 private:
  cia402::State state_ = cia402::State::kNotReady;
  std::uint16_t controlword_ = 0;
  std::int64_t failed_ns_ = 0;
};

}  // namespace limber::sim
