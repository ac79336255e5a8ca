#include "drivers/drive.h"

#include <cmath>

namespace limber {

Drive::Drive(const JointConfig& joint, bool fd, double rate_hz, int bridged_cycles)
    : link_(joint, fd, 1.0 / rate_hz, bridged_cycles),
      configure_(&link_.family()),
      watch_(static_cast<int>(std::ceil(rate_hz)), bridged_cycles) {}

void Drive::enter(DriveState state, double held) noexcept {
  switch (state) {
    case DriveState::kConfiguring:
      configure_.start();
      link_.forget_angle();
      break;
    case DriveState::kOff:
      watch_.reset();
      break;
    case DriveState::kEnabling:
      enable_.start(link_);
      break;
    case DriveState::kHold:
      hold_.start(held);
      break;
    case DriveState::kOn:
    case DriveState::kDamp:
    case DriveState::kFault:
      break;
  }
}

CanFrame Drive::next_frame(DriveState state, double tau, bool settling) noexcept {
  switch (state) {
    case DriveState::kConfiguring:
      return configure_.next_frame();
    case DriveState::kOff:
      return poll();
    case DriveState::kEnabling:
      return enable_.next_frame(&link_);
    case DriveState::kOn:
      return link_.torque(tau);
    case DriveState::kHold:
      // A drive that left the enabled state by itself is not spoken to as if it had not.
      if (!link_.enabled()) return link_.state_request();
      return link_.command(hold_.command(link_, settling, watch_.trusted()));
    case DriveState::kDamp:
      if (!link_.enabled()) return link_.state_request();
      return link_.command(damp(link_));
    case DriveState::kFault:
      break;
  }
  return link_.disable();  // until it is confirmed and after: it may be lost
}

CanFrame Drive::poll() noexcept {
  return link_.enabled() ? link_.disable() : link_.state_request();
}

void Drive::begin_cycle() noexcept {
  answered_ = false;
  link_.begin_cycle();
}

void Drive::receive(DriveState state, const CanFrame& frame) noexcept {
  if (asked(state)) {
    if (configure_.receive(frame)) {
      answered_ = true;
    } else if (!link_.is_aside(frame)) {
      ++invalid_;
    }
    return;
  }
  // An arm that nobody drives may swing as it likes, and whoever drives it next needs its angle.
  if (state == DriveState::kOff) link_.forget_angle();
  if (!link_.receive(frame)) {
    if (!link_.is_aside(frame)) ++invalid_;
    return;
  }
  answered_ = true;
  if (state == DriveState::kConfiguring) configure_.receive_state(link_.enabled());
}

void Drive::receive_late(DriveState state, const CanFrame& frame) noexcept {
  if (asked(state) && configure_.receive(frame)) return;
  if (!link_.is_aside(frame)) ++late_;
}

void Drive::close_cycle(DriveState state, std::int64_t cycle) noexcept {
  const bool configuring = state == DriveState::kConfiguring;
  if (!answered_ && !(configuring && configure_.may_be_unanswered())) ++missing_;
  if (configuring) {
    configure_.close_cycle();
    return;
  }
  if (state == DriveState::kEnabling) enable_.close_cycle(link_);
  watch_.close_cycle(link_.fresh(), cycle);
}

}  // namespace limber
