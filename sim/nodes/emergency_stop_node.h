// An emulated emergency stop: a digital input that sends its state by itself.
#pragma once

#include <cstdint>
#include <limber/scenario_event_t.hpp>

#include "drivers/can/can_frame.h"
#include "robots/loader/emergency_stop_config.h"

namespace limber::sim {

/// Five times within its timeout. After construction every member is allowed in the cycle.
class EmergencyStopNode {
 public:
  explicit EmergencyStopNode(const EmergencyStopConfig& config)
      : config_(config), interval_ns_(static_cast<std::int64_t>(0.2e9 * config.timeout_s)) {}

  int bus() const noexcept { return config_.bus; }
  /// True if a frame is due at this simulated time.
  bool next(std::int64_t now_ns, CanFrame* frame) noexcept {
    if (now_ns < due_ns_) return false;
    due_ns_ = now_ns + interval_ns_;
    if (now_ns < silent_until_ns_) return false;
    *frame = CanFrame();
    frame->id = config_.id;
    frame->length = static_cast<std::uint8_t>(config_.byte + 1);
    const bool pressed = now_ns < pressed_until_ns_;
    frame->data[static_cast<std::size_t>(config_.byte)] =
        static_cast<std::uint8_t>(pressed ? ~config_.released & config_.mask : config_.released);
    return true;
  }
  /// FAULT_PRESSED or FAULT_SILENT until a simulated time.
  void inject(int fault, std::int64_t until_ns) noexcept {
    (fault == scenario_event_t::FAULT_SILENT ? silent_until_ns_ : pressed_until_ns_) = until_ns;
    due_ns_ = 0;  // an input tells a change at once
  }
  void clear_faults() noexcept { silent_until_ns_ = pressed_until_ns_ = 0; }

 private:
  EmergencyStopConfig config_;
  std::int64_t interval_ns_;
  std::int64_t due_ns_ = 0;
  std::int64_t pressed_until_ns_ = 0;
  std::int64_t silent_until_ns_ = 0;
};

}  // namespace limber::sim
