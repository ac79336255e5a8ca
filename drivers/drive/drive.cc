#include "drivers/drive/drive.h"

#include <algorithm>
#include <cmath>

namespace limber {
namespace {

constexpr int kHotReplies = 10;

}  // namespace

Drive::Drive(const JointConfig& joint, bool fd, double rate_hz, int bridged_cycles)
    : link_(joint, fd, 1.0 / rate_hz, bridged_cycles),
      configure_(link_.family()),
      settings_(std::make_unique<SettingsWatch>(link_.family().startup.get())),
      fallback_(joint.torque_rate_limit_Nm_per_s / rate_hz),
      watch_(static_cast<int>(std::ceil(rate_hz)), bridged_cycles),
      feedback_(link_),
      warmth_(joint.drive.warning_temperature_degC),
      heat_limit_(joint.drive.limit_temperature_degC, kHotReplies),
      invalid_window_(bridged_cycles),
      cycles_per_second_(static_cast<int>(std::ceil(rate_hz))) {}

void Drive::enter(DriveState state, double present, double held) noexcept {
  switch (state) {
    case DriveState::kConfiguring:
      configure_.start();
      settings_->start();
      link_.forget_angle();
      break;
    case DriveState::kOff:
      acknowledge();
      break;
    case DriveState::kEnabling:
      enable_.start(link_);
      break;
    case DriveState::kFallback:
      fallback_.start(present, held);
      break;
    case DriveState::kDamp:
      if (entered_ == DriveState::kFallback) {
        fallback_.go_on_to(0.0);
      } else {
        fallback_.start(present, 0.0);
      }
      break;
    case DriveState::kOn:
    case DriveState::kFault:
      break;
  }
  entered_ = state;
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
    case DriveState::kFallback:
      // A drive that left the enabled state by itself gets no commands.
      if (!link_.enabled()) return link_.state_request();
      return hold(settling);
    case DriveState::kDamp:
      if (!link_.enabled()) return link_.state_request();
      return link_.command(fallback_.damp(link_));
    case DriveState::kFault:
      break;
  }
  return link_.disable();  // also when confirmed: a frame may have been lost before
}

CanFrame Drive::hold(bool settling) noexcept {
  // Angle or velocity is wrong, nobody knows which. A drive damps by the velocity that it reports:
  // a wrong one would drive the joint, and so would a hold at an angle that drifts.
  const bool motion_known = contradiction() != Contradiction::kVelocity;
  const bool angle_known = watch_.trusted() && !link_.jumped() && motion_known && credible();
  return link_.command(fallback_.hold(link_, settling, {angle_known, motion_known}));
}

CanFrame Drive::poll() noexcept {
  return link_.enabled() ? link_.disable() : link_.state_request();
}

void Drive::begin_cycle() noexcept {
  answered_ = false;
  link_.begin_cycle();
}

void Drive::receive(DriveState state, const CanFrame& frame) noexcept {
  if (awaits_answer(state)) {
    if (configure_.receive(frame)) {
      answered_ = true;
    } else if (!link_.answers_foreign(frame) && !link_.take_unsolicited(frame)) {
      ++invalid_;
    }
    return;
  }
  if (settings_->receive(frame) || link_.answers_foreign(frame)) return;
  expect_angle(state);
  if (!link_.receive(frame)) {
    if (!link_.take_unsolicited(frame)) count_invalid();
    return;
  }
  if (!link_.fresh()) return;  // a part of a state
  answered_ = true;
  if (state == DriveState::kConfiguring) configure_.receive_state(link_.enabled());
}

// Without power an arm may swing at any speed: the next angle is taken as it comes. While the
// others hold, so is that of a drive that was lost, but it is not held there before it is
// acknowledged.
void Drive::expect_angle(DriveState state) noexcept {
  if (state == DriveState::kOff || state == DriveState::kFault) link_.forget_angle();
  const bool given_up = state == DriveState::kFallback || state == DriveState::kDamp;
  link_.take_jumps(given_up && watch_.lost());
}

void Drive::count_invalid() noexcept {
  ++invalid_;
  const bool first = invalid_cycle_ != cycle_;  // a state may be several frames
  invalid_cycle_ = cycle_;
  if (first && invalid_window_.add(cycle_, cycles_per_second_)) often_invalid_ = true;
}

void Drive::receive_late(DriveState state, const CanFrame& frame) noexcept {
  const bool startup = awaits_answer(state);
  if (!startup && (settings_->receive(frame) || link_.take_unsolicited(frame))) return;
  if (link_.answers_foreign(frame)) return;
  if (startup) {  // where an answer may take two cycles
    if (configure_.receive(frame)) late_answer_ = true;
    return;
  }
  ++late_;
  expect_angle(state);
  if (!link_.receive(frame, 1)) {
    count_invalid();
    return;
  }
  if (link_.age_cycles() > 1) return;  // a part of a state
  watch_.came_late();
  if (counted_missing_) --missing_;
  counted_missing_ = false;
}

void Drive::close_cycle(DriveState state, std::int64_t cycle, double time_s) noexcept {
  const bool doubted = invalid_cycle_ == cycle_;  // a reply of the cycle that ends
  agreeing_cycles_ = link_.fresh() && !doubted ? agreeing_cycles_ + 1 : 0;
  cycle_ = cycle;
  check_feedback(state, time_s);
  if (state == DriveState::kConfiguring) {
    // A dialogue shares the wire with those of all other drives: its answer may take two cycles.
    const bool heard = answered_ || late_answer_ || configure_.may_be_unanswered();
    silent_cycles_ = heard ? 0 : silent_cycles_ + 1;
    late_answer_ = false;
    if (silent_cycles_ > 2) ++missing_;
    configure_.close_cycle();
    return;
  }
  counted_missing_ = !answered_ && !doubted;
  if (counted_missing_) ++missing_;
  if (state == DriveState::kEnabling) enable_.close_cycle(link_);
  const bool was_lost = watch_.lost();
  watch_.close_cycle(link_.fresh(), cycle);
  if (doubted && watch_.lost() && !was_lost) often_invalid_ = true;  // it came, and is the cause
}

void Drive::check_feedback(DriveState state, double time_s) noexcept {
  const bool powered =
      state == DriveState::kOn || state == DriveState::kFallback || state == DriveState::kDamp;
  if (link_.fresh()) {
    warmth_.add(link_.temperature_degC());
    heat_limit_.add(link_.temperature_degC());
  }
  if (!powered) ignoring_cycles_ = 0;
  // A drive that is given up since its angle jumped is not held against that angle.
  if (!powered || link_.jumped()) {
    feedback_.reset();
  } else if (link_.fresh()) {
    feedback_.add(link_, time_s);
    ignoring_cycles_ = link_.ignores_target() ? ignoring_cycles_ + 1 : 0;
  }
}

DriveWarning Drive::warning() const noexcept {
  DriveWarning warning;
  warning.hot = warmth_.hot();
  warning.too_hot = too_hot();
  warning.flagged = link_.warns();
  // Of a drive in fault it is the fault's cause, and told with that.
  if (!link_.drive_error()) warning.emergency = link_.emergency();
  warning.temperature_degC = static_cast<std::int16_t>(std::clamp(
      std::round(link_.temperature_degC()), -DriveWarning::kMost_degC, DriveWarning::kMost_degC));
  return warning;
}

}  // namespace limber
