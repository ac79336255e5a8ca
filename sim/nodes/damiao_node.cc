#include "sim/nodes/damiao_node.h"

#include <algorithm>
#include <cmath>
#include <limber/scenario_event_t.hpp>

#include "sim/nodes/five_numbers.h"

namespace limber::sim {
namespace {

constexpr std::uint8_t kMotorPosition = 80;
constexpr std::uint8_t kOutputPosition = 81;
/// Some clients send special frames to the id of another mode.
constexpr std::uint32_t kLastModeOffset = mit::id_offset(mit::ControlMode::kForcePosition);

}  // namespace

DamiaoNode::DamiaoNode(const JointConfig& joint, bool fd)
    : drive_(joint.drive), registers_(joint.drive, fd) {}

DamiaoNode::Sensed DamiaoNode::sense(const JointReading& joint) const noexcept {
  const double torque = drive_.sign * joint.motor_torque;
  if (has(scenario_event_t::FAULT_FROZEN_ENCODER)) return {frozen_position_, 0.0, torque};
  return {counted_angle(drive_, joint.theta) + zero_, drive_.sign * joint.theta_dot, torque};
}

CanFrame DamiaoNode::state_frame(const CanFrame& request,
                                 const JointReading& joint) const noexcept {
  const Sensed sensed = sense(joint);
  mit::Reply reply;
  reply.id_nibble = static_cast<std::uint8_t>(registers_.id() & 0xF);
  reply.error = state_;
  reply.position_rad = sensed.position;
  reply.velocity_rad_per_s = sensed.velocity;
  reply.torque_Nm = sensed.torque;
  reply.mos_temperature_degC = reply.rotor_temperature_degC =
      static_cast<int>(temperature_degC(drive_));
  CanFrame frame = mit::encode_reply(reply, registers_.range(), registers_.reply_id(), request.fd,
                                     mit::Quantiser::kTruncate);
  frame.bitrate_switch = request.bitrate_switch;
  return frame;
}

bool DamiaoNode::receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
                         CanFrame* reply) noexcept {
  pass_time(joint, now_ns);
  if (frame.extended || frame.remote || frame.error || !registers_.hears_the_bus()) return false;
  const bool deaf = has(scenario_event_t::FAULT_DROP_COMMANDS);

  mit::RegisterRequest request;
  if (frame.id == mit::kRegisterId) {
    if (!mit::decode_register_request(frame, &request) || request.id != registers_.id()) {
      return false;
    }
    if (!deaf) last_frame_ns_ = now_ns;
    return on_register(frame, request, joint, reply) && !has(scenario_event_t::FAULT_SILENT);
  }

  const std::uint32_t offset = frame.id - registers_.id();
  if (offset > kLastModeOffset) return false;  // another drive's
  mit::Special special{};
  const bool is_special = mit::decode_special(frame, &special);
  const bool other_mode = is_special && offset % mit::kModeStep == 0;
  const bool servo = offset != 0 && offset == mit::id_offset(registers_.mode());
  const std::uint8_t shortest = registers_.mode() == mit::ControlMode::kVelocity ? 4 : 8;
  const bool whole = servo ? frame.length >= shortest && frame.length <= 8 : frame.length == 8;
  if ((offset != 0 && !other_mode && !servo) || !whole) return false;
  *reply = state_frame(frame, joint);
  if (!deaf) {
    last_frame_ns_ = now_ns;
    if (is_special) {
      on_special(special, joint);
    } else if (servo) {
      on_servo_command(frame, joint);
    } else {
      on_command(frame);
    }
  }
  return !has(scenario_event_t::FAULT_SILENT);
}

bool DamiaoNode::on_register(const CanFrame& frame, const mit::RegisterRequest& request,
                             const JointReading& joint, CanFrame* reply) noexcept {
  if (request.operation == mit::kStateRequest) {
    *reply = state_frame(frame, joint);
    return true;
  }
  std::uint32_t value = request.raw_value;
  // The answer to a new identifier still has the old one.
  const std::uint32_t reply_id = registers_.reply_id();
  if (request.operation == mit::kWriteRegister && !has(scenario_event_t::FAULT_DROP_COMMANDS)) {
    registers_.write(request.reg, request.raw_value);
    if (request.reg == static_cast<std::uint8_t>(mit::Register::kControlMode)) forget_command();
  }
  if (request.operation == mit::kReadRegister || request.operation == mit::kWriteRegister) {
    const auto position = static_cast<float>(sense(joint).position);
    value = request.reg == kOutputPosition ? mit::float_bits(position)
            : request.reg == kMotorPosition
                ? mit::float_bits(position * static_cast<float>(drive_.gear_ratio))
                : registers_.read(request.reg);
  }
  mit::RegisterRequest answered = request;
  // Flash is written at rest only.
  if (request.operation == mit::kStoreRegister)
    answered.reg = state_ == mit::DriveError::kEnabled ? 0 : 1;
  *reply = mit::encode_register_answer(answered, value, reply_id, frame.fd);
  reply->bitrate_switch = frame.bitrate_switch;
  return true;
}

void DamiaoNode::on_special(mit::Special special, const JointReading& joint) noexcept {
  const bool enabled = state_ == mit::DriveError::kEnabled;
  const bool failed = !enabled && state_ != mit::DriveError::kDisabled;
  switch (special) {
    case mit::Special::kEnable:
      if (!failed) state_ = mit::DriveError::kEnabled;
      if (!enabled) forget_command();
      break;
    case mit::Special::kDisable:
      if (enabled) leave(mit::DriveError::kDisabled);
      break;
    case mit::Special::kClearError:
      if (failed && !has(scenario_event_t::FAULT_DRIVE_ERROR)) leave(mit::DriveError::kDisabled);
      break;
    case mit::Special::kSetZero:
      // Obeyed at rest only: a zero that moves under a working position loop is a jump.
      if (!enabled) zero_ -= sense(joint).position;
      break;
  }
}

void DamiaoNode::on_command(const CanFrame& frame) noexcept {
  mit::Command command;
  if (state_ != mit::DriveError::kEnabled || registers_.mode() != mit::ControlMode::kMit ||
      !mit::decode_command(frame, registers_.range(), &command)) {
    return;
  }
  command_ = command;
}

void DamiaoNode::on_servo_command(const CanFrame& frame, const JointReading& joint) noexcept {
  mit::ServoCommand command;
  if (state_ != mit::DriveError::kEnabled ||
      !mit::decode_servo_command(frame, registers_.mode(), &command)) {
    return;
  }
  if (!has_setpoint_) setpoint_.start(sense(joint).position, 0.0);
  has_setpoint_ = true;
  torque_share_ = command.torque_share;
  const double most = registers_.most_speed_rad_per_s();
  ProfileGoal goal;
  goal.acceleration_limit = registers_.acceleration_rad_per_s2();
  if (registers_.mode() == mit::ControlMode::kVelocity) {
    goal.velocity = std::clamp(command.velocity_rad_per_s, -most, most);
  } else {
    goal.position = command.position_rad;
    goal.velocity_limit = std::min(command.velocity_rad_per_s, most);
  }
  setpoint_.aim(goal);
}

/// Moves the setpoint on, but no further from the joint than the torque can pull: one that stands
/// in front of an obstacle does not wind up.
void DamiaoNode::pass_time(const JointReading& joint, std::int64_t now_ns) noexcept {
  const double passed_s = static_cast<double>(now_ns - now_ns_) * 1e-9;
  now_ns_ = now_ns;
  if (!has_setpoint_) return;
  const CommandRange range = registers_.range();
  const double here = sense(joint).position;
  const double reach = most_torque() / range.kp_Nm_per_rad;
  setpoint_.advance(passed_s);
  setpoint_.keep_within(here - reach, here + reach);
  command_ = {setpoint_.position(), setpoint_.velocity(), range.kp_Nm_per_rad, range.kd_Nms_per_rad,
              0.0};
}

void DamiaoNode::forget_command() noexcept {
  command_ = {};
  has_setpoint_ = false;
  torque_share_ = 1.0;
}

void DamiaoNode::leave(mit::DriveError state) noexcept {
  state_ = state;
  forget_command();
  shorted_ = state == mit::DriveError::kCommunicationLost &&
             drive_.watchdog_reaction == NodeWatchdogReaction::kDamp;
}

void DamiaoNode::update(const JointReading& joint, std::int64_t now_ns) noexcept {
  pass_time(joint, now_ns);
  const std::int64_t timeout = registers_.timeout_ns();
  if (state_ == mit::DriveError::kEnabled && timeout > 0 && now_ns - last_frame_ns_ > timeout) {
    leave(mit::DriveError::kCommunicationLost);
  }
}

double DamiaoNode::most_torque() const noexcept {
  return sim::most_torque(drive_, registers_.range());
}

DriveLaw DamiaoNode::law() const noexcept {
  if (state_ != mit::DriveError::kEnabled)
    return {.passive_damping = shorted_ ? drive_.short_circuit_damping_Nms : 0.0};
  return law_of(
      command_, drive_, zero_,
      has(scenario_event_t::FAULT_FROZEN_ENCODER) ? std::optional(frozen_position_) : std::nullopt,
      torque_share_ * most_torque());
}

void DamiaoNode::on_fault(int fault, const JointReading& joint) noexcept {
  if (fault == scenario_event_t::FAULT_FROZEN_ENCODER) frozen_position_ = sense(joint).position;
  if (fault == scenario_event_t::FAULT_DRIVE_ERROR) leave(mit::DriveError::kOverCurrent);
}

}  // namespace limber::sim
