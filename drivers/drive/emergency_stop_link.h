// The driver's end of the emergency stop on the bus.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limber/joint_state_t.hpp>
#include <vector>

#include "drivers/can/can_filter.h"
#include "drivers/can/can_frame.h"
#include "robots/loader/emergency_stop_config.h"

namespace limber {

/// Pressed, or silent for timeout_s, is stopped; and it stays so for power_off_s at least, so that
/// a stop that was begun is completed. Until timeout_s after the start silence is no stop.
/// Everything but the constructor and add_receive_filters() is allowed inside the cycle.
class EmergencyStopLink {
 public:
  EmergencyStopLink(const EmergencyStopConfig& config, double rate_hz) noexcept
      : config_(config),
        timeout_cycles_(std::max(whole(config.timeout_s * rate_hz), std::int64_t{1})),
        power_off_cycles_(whole(config.power_off_s * rate_hz)) {}

  bool is_mine(std::size_t bus, const CanFrame& frame) const noexcept {
    return bus == static_cast<std::size_t>(config_.bus) && has_id(frame, config_.id);
  }
  void add_receive_filters(std::size_t bus, std::vector<CanFilter>* filters) const {
    if (bus == static_cast<std::size_t>(config_.bus)) filters->push_back(exactly(config_.id));
  }
  /// A frame that is too short tells nothing.
  void receive(const CanFrame& frame) noexcept {
    if (frame.length <= config_.byte) return;
    const auto byte = static_cast<std::size_t>(config_.byte);
    pressed_ = (frame.data[byte] & config_.mask) != config_.released;
    silent_cycles_ = 0;
  }
  /// Once a cycle, after its frames.
  void close_cycle() noexcept {
    ++silent_cycles_;
    if (pressed_ || silent()) {
      ++stopped_cycles_;
    } else if (power_is_off()) {
      stopped_cycles_ = 0;
    } else if (stopped_cycles_ > 0) {
      ++stopped_cycles_;
    }
  }

  bool stopped() const noexcept { return stopped_cycles_ > 0; }
  /// The drives have held for power_off_s: now they are to be disabled.
  bool power_is_off() const noexcept { return stopped_cycles_ > power_off_cycles_; }
  /// STOP_* of joint_state_t.
  std::int8_t state() const noexcept {
    if (silent()) return joint_state_t::STOP_SILENT;
    return stopped() ? joint_state_t::STOP_PRESSED : joint_state_t::STOP_RELEASED;
  }

 private:
  static std::int64_t whole(double cycles) noexcept { return static_cast<std::int64_t>(cycles); }
  bool silent() const noexcept { return silent_cycles_ > timeout_cycles_; }

  EmergencyStopConfig config_;
  std::int64_t timeout_cycles_;
  std::int64_t power_off_cycles_;
  bool pressed_ = false;
  std::int64_t silent_cycles_ = 0;
  std::int64_t stopped_cycles_ = 0;
};

}  // namespace limber
