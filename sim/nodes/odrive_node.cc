#include "sim/nodes/odrive_node.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limber/scenario_event_t.hpp>
#include <limits>
#include <numbers>

#include "sim/nodes/encoder_counts.h"

namespace limber::sim {
namespace {

using odrive::Message;

constexpr std::int64_t kOdriveMs_ns = 1'000'000;
constexpr std::uint64_t kOdriveSerials = 0x3000'0000'0000;
constexpr std::uint32_t kOdriveCalibration = 3;
constexpr double kOdriveTurn_rad = 2.0 * std::numbers::pi;

}  // namespace

OdriveNode::OdriveNode(const JointConfig& joint)
    : drive_(joint.drive),
      saved_{.node = odrive::node_of(drive_.command_id), .calibrated = true},
      settings_(saved_),
      heartbeat_ns_(settings_.node * kOdriveMs_ns) {}  // each has its own clock

float OdriveNode::turns(const JointReading& joint) const noexcept {
  if (!settings_.calibrated) return std::numeric_limits<float>::quiet_NaN();
  if (has(scenario_event_t::FAULT_FROZEN_ENCODER)) return frozen_turns_;
  const double counts = drive_.counts_per_turn / drive_.gear_ratio;  // a turn of the motor
  const double turns =
      (drive_.sign * joint.theta + drive_.offset_rad) * drive_.gear_ratio / kOdriveTurn_rad;
  return static_cast<float>(whole_counts(turns * counts) / counts + zero_turns_);
}

float OdriveNode::turns_per_s(const JointReading& joint) const noexcept {
  if (has(scenario_event_t::FAULT_FROZEN_ENCODER)) return 0.0F;
  return static_cast<float>(drive_.sign * joint.theta_dot * drive_.gear_ratio / kOdriveTurn_rad);
}

CanFrame OdriveNode::told(Message message, const JointReading& joint) const noexcept {
  const std::uint32_t node = settings_.node;
  const auto tell = [&](auto... fields) { return odrive::encode(node, message, fields...); };
  switch (message) {
    case Message::kVersion:  // protocol 2, hardware 4.4
      return tell(0x00040402U, __builtin_bswap32(drive_.firmware << 8U));
    case Message::kHeartbeat:
      return tell(errors_, state_ | result_ << 8U | 1U << 16U);
    case Message::kError:
      return tell(errors_, disarm_reason_);
    case Message::kAddress:
      return tell((kOdriveSerials | odrive::node_of(drive_.command_id)) << 8U | node);
    case Message::kEstimates:
      return tell(turns(joint), turns_per_s(joint));
    case Message::kTemperature:
      return tell(30.0F, 30.0F);
    case Message::kSupply:
      return tell(48.0F, 0.0F);
    case Message::kTorques:
      return tell(torque_Nm_,
                  static_cast<float>(drive_.sign * joint.motor_torque / drive_.gear_ratio));
    default:
      return {};
  }
}

bool OdriveNode::receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
                         CanFrame* reply) noexcept {
  now_ns_ = now_ns;
  const std::uint32_t node = odrive::node_of(frame.id);
  const bool mine = node == settings_.node && node != odrive::kEverybody;
  if (frame.extended || frame.error || frame.fd || now_ns < deaf_until_ns_ ||
      (!mine && node != odrive::kEverybody))
    return false;
  const auto message = static_cast<Message>(frame.id & 0x1FU);
  bool answered = false;
  if (odrive::asks(frame)) {
    *reply = told(message, joint);
    answered = reply->length > 0 && (mine || message == Message::kAddress);
  }
  if (message == Message::kWriteEndpoint) answered = mine && endpoint(frame, reply);
  if (!frame.remote && !has(scenario_event_t::FAULT_DROP_COMMANDS)) obey(frame, joint);
  return answered && !has(scenario_event_t::FAULT_SILENT);
}

void OdriveNode::obey(const CanFrame& frame, const JointReading& joint) noexcept {
  const auto is = [&](Message message, int bytes) {
    return odrive::is_message(frame, odrive::node_of(frame.id), message, bytes);
  };
  const auto number = odrive::field<float>(frame, 0);
  if (is(Message::kTorque, 4)) {
    torque_Nm_ = enabled() && std::isfinite(number) ? number : 0.0F;
    fed_ns_ = now_ns_;
  } else if (is(Message::kSetState, 4)) {
    set_state(odrive::field<std::uint32_t>(frame, 0));
  } else if (is(Message::kSetMode, 8)) {
    settings_.raw[kOdriveControlMode] = frame.data[0];
    settings_.raw[kOdriveInputMode] = frame.data[4];
  } else if (is(Message::kSetLimits, 8)) {
    settings_.raw[kOdriveVelocityLimit] = std::bit_cast<std::uint32_t>(number);
    settings_.most_A = odrive::field<float>(frame, 4);
  } else if (is(Message::kEstop, 0)) {
    disarm(odrive::kEstopped);
  } else if (is(Message::kClearErrors, 0)) {
    errors_ = has(scenario_event_t::FAULT_DRIVE_ERROR) ? odrive::kOverCurrent : 0;
    disarm_reason_ = 0;
  } else if (is(Message::kSetPosition, 4)) {
    if (settings_.calibrated && std::isfinite(number)) zero_turns_ += number - turns(joint);
  } else if (is(Message::kAddress, 7)) {
    const CanFrame own = told(Message::kAddress, joint);
    const bool meant = std::equal(&own.data[1], &own.data[7], &frame.data[1]);
    if (meant) settings_.node = frame.data[0] & odrive::kEverybody;
  } else if (is(Message::kReboot, 1)) {
    reboot(frame.data[0], joint);
  }
}

void OdriveNode::set_state(std::uint32_t wanted) noexcept {
  const bool loop = wanted == odrive::kClosedLoop;
  settings_.calibrated = settings_.calibrated || wanted == kOdriveCalibration;  // in no time
  const bool may = loop && settings_.calibrated && errors_ == 0;
  state_ = may ? wanted : odrive::kIdle;
  result_ = loop && !settings_.calibrated ? odrive::kNotCalibrated : 0;
  torque_Nm_ = 0.0F;
  fed_ns_ = now_ns_;
  if (may) disarm_reason_ = 0;
}

bool OdriveNode::endpoint(const CanFrame& frame, CanFrame* reply) noexcept {
  const auto number = odrive::field<std::uint16_t>(frame, 1);
  const auto which = static_cast<std::size_t>(std::ranges::find(drive_.endpoints, number) -
                                              drive_.endpoints.begin());
  if (frame.remote || frame.length < 4 || which == drive_.endpoints.size()) return false;
  const auto bytes = static_cast<std::uint8_t>(4 + kOdriveEndpoints[which].bytes);
  settings_.raw[kOdriveState] = state_;
  if (frame.data[0] != 0) {
    if (frame.length >= bytes && which != kOdriveState &&
        !has(scenario_event_t::FAULT_DROP_COMMANDS))
      std::memcpy(&settings_.raw[which], frame.data.data() + 4, bytes - 4U);
    return false;
  }
  *reply = odrive::encode(settings_.node, Message::kEndpoint, std::uint8_t{0}, number,
                          std::uint8_t{0}, settings_.raw[which]);
  reply->length = bytes;
  return true;
}

/// 0: only that; 1: saves, which it does while idle; 2: is as delivered.
void OdriveNode::reboot(int action, const JointReading& joint) noexcept {
  if (action > 2 || (action == 1 && enabled())) return;
  if (action > 0) saved_ = action == 1 ? settings_ : Settings{};
  settings_ = saved_;
  if (settings_.calibrated) zero_turns_ -= std::round(turns(joint));
  set_state(odrive::kIdle);
  errors_ = disarm_reason_ = 0;
  deaf_until_ns_ = now_ns_ + 500 * kOdriveMs_ns;
}

void OdriveNode::disarm(std::uint32_t error) noexcept {
  errors_ |= error;
  if (state_ == odrive::kIdle) return;
  set_state(odrive::kIdle);
  disarm_reason_ |= error;
  result_ = odrive::kDisarmed;
}

bool OdriveNode::next_frame(CanFrame* frame) noexcept {
  const std::int64_t period_ns = settings_.raw[kOdriveEstimatesPeriod] * kOdriveMs_ns;
  const bool beats = now_ns_ >= heartbeat_ns_;
  const bool estimates = period_ns > 0 && now_ns_ >= estimates_ns_;
  if (has(scenario_event_t::FAULT_SILENT) || now_ns_ < deaf_until_ns_ || (!beats && !estimates))
    return false;
  (beats ? heartbeat_ns_ : estimates_ns_) = now_ns_ + (beats ? 100 * kOdriveMs_ns : period_ns);
  *frame = told(beats ? Message::kHeartbeat : Message::kEstimates, joint_);
  return true;
}

void OdriveNode::update(const JointReading& joint, std::int64_t now_ns) noexcept {
  now_ns_ = now_ns;
  joint_ = joint;
  if (!has(scenario_event_t::FAULT_DRIVE_ERROR)) errors_ &= ~odrive::kOverCurrent;
  const double silent_s = 1e-9 * static_cast<double>(now_ns - fed_ns_);
  if (enabled() && settings_.raw[kOdriveWatchdog] != 0 &&
      !(silent_s <= settings_.real(kOdriveTimeout)))
    disarm(odrive::kWatchdogExpired);
}

DriveLaw OdriveNode::law() const noexcept {
  if (!enabled() || settings_.raw[kOdriveControlMode] != odrive::kTorqueControl) return {};
  const double most = std::fmax(settings_.real(kOdriveVelocityLimit), 0.0);
  const double speed = turns_per_s(joint_);
  const double torque =
      std::fmax(std::fmin(torque_Nm_, (most - speed) * odrive::kVelocityGain_Nms_per_turn),
                (-most - speed) * odrive::kVelocityGain_Nms_per_turn);
  const double most_Nm = std::fmax(settings_.most_A, 0.0) * drive_.torque_constant_Nm_per_A;
  return {.tau_ff = drive_.sign * torque * drive_.gear_ratio,
          .limit = std::fmin(drive_.peak_torque_Nm, most_Nm)};
}

void OdriveNode::on_fault(int fault, const JointReading& joint) noexcept {
  if (fault == scenario_event_t::FAULT_FROZEN_ENCODER) frozen_turns_ = turns(joint);
  if (fault == scenario_event_t::FAULT_DRIVE_ERROR) disarm(odrive::kOverCurrent);
}

}  // namespace limber::sim
