#include "sim/nodes/moteus_node.h"

#include <algorithm>
#include <cmath>
#include <limber/scenario_event_t.hpp>
#include <numbers>

namespace limber::sim {
namespace {

using moteus::Mode;
using moteus::Register;

constexpr double kTurn_rad = 2.0 * std::numbers::pi;  // rad
constexpr double kConfiguredWatchdog_s = 0.1;
constexpr std::int64_t kEnablingMode_ns = 1'000'000;  // in each of modes 2, 3, 4
constexpr int kDriverFault = 33;
constexpr double kBoardTemperature_degC = 30.0;
constexpr double kVoltage_V = 48.0;
constexpr double kModel = 0x0200;
constexpr double kFirmware = 0x0100;
constexpr double kHomedOutput = 2.0;
constexpr unsigned kMostValues = 60;

}  // namespace

MoteusNode::MoteusNode(const JointConfig& joint)
    : drive_(joint.drive), id_(moteus::address_of(joint.drive.command_id).destination) {}

MoteusNode::Sensed MoteusNode::sense(const JointReading& joint) const noexcept {
  const double torque = drive_.sign * joint.motor_torque;
  if (has(scenario_event_t::FAULT_FROZEN_ENCODER)) return {frozen_turns_, 0.0, torque};
  const double counts = drive_.counts_per_turn;
  const double turns = (drive_.sign * joint.theta + drive_.offset_rad) / kTurn_rad;
  return {std::floor(turns * counts) / counts + zero_turns_,
          drive_.sign * joint.theta_dot / kTurn_rad, torque};
}

// --- frames --------------------------------------------------------------------------------------

bool MoteusNode::receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
                         CanFrame* reply) noexcept {
  now_ns_ = now_ns;
  if (frame.remote || frame.error) return false;
  const moteus::Address to = moteus::address_of(frame.id);
  if (to.prefix != 0 || (to.destination != id_ && to.destination != moteus::kBroadcast))
    return false;
  moteus::FrameWriter answer(moteus::can_id({id_, to.source, false, 0}));
  moteus::FrameReader reader(frame);
  moteus::Subframe subframe;
  Request request;
  while (reader.next(&subframe)) work(subframe, joint, &request, &answer);
  if (request.wanted) change_mode(request.mode, joint);
  *reply = answer.frame();
  reply->fd = frame.fd || reply->length > 8;
  reply->bitrate_switch = frame.bitrate_switch;
  return to.reply_wanted && !has(scenario_event_t::FAULT_SILENT);
}

void MoteusNode::work(const moteus::Subframe& subframe, const JointReading& joint, Request* request,
                      moteus::FrameWriter* answer) noexcept {
  if (subframe.kind == moteus::Subframe::Kind::kRead) answer_read(subframe, joint, answer);
  if (subframe.kind != moteus::Subframe::Kind::kWrite) return;
  if (has(scenario_event_t::FAULT_DROP_COMMANDS)) return;
  for (unsigned i = 0; i < subframe.count; ++i) {
    write(static_cast<std::uint16_t>(subframe.first + i), subframe.value(i), joint, request,
          answer);
  }
}

void MoteusNode::write(std::uint16_t reg, double value, const JointReading& joint, Request* request,
                       moteus::FrameWriter* answer) noexcept {
  if (MoteusCommand::has(reg)) {
    written_.set(reg, value);
    return;
  }
  double present = 0.0;
  const double here = sense(joint).turns;
  switch (static_cast<Register>(reg)) {
    case Register::kMode:
      written_.reset();
      request->wanted = value >= 0.0 && value <= moteus::kLastMode;
      if (request->wanted) request->mode = static_cast<Mode>(value);
      break;
    case Register::kSetOutputNearest:
      if (std::isfinite(value)) zero_turns_ += std::round(value - here);
      break;
    case Register::kSetOutputExact:
      if (std::isfinite(value)) zero_turns_ += value - here;
      break;
    default:
      answer->write_error(
          reg, read(reg, joint, &present) ? moteus::kNotWritable : moteus::kUnknownRegister);
  }
}

void MoteusNode::answer_read(const moteus::Subframe& subframe, const JointReading& joint,
                             moteus::FrameWriter* answer) const noexcept {
  std::array<double, kMostValues> values;
  for (unsigned i = 0; i < subframe.count; ++i) {
    const auto reg = static_cast<std::uint16_t>(subframe.first + i);
    if (i < kMostValues && read(reg, joint, &values[i])) continue;
    answer->read_error(reg, moteus::kUnknownRegister);
    return;
  }
  answer->reply(subframe.type, subframe.first, std::span(values.data(), subframe.count));
}

bool MoteusNode::read(std::uint16_t reg, const JointReading& joint, double* value) const noexcept {
  const auto is = [value](double content) {
    *value = content;
    return true;
  };
  if (MoteusCommand::has(reg)) return is(written_.raw(reg));
  const Sensed sensed = sense(joint);
  const DriveLaw now = law();
  switch (static_cast<Register>(reg)) {
    case Register::kMode:
      return is(static_cast<double>(mode_));
    case Register::kPosition:
      return is(sensed.turns);
    case Register::kAbsolutePosition:
      return is(sensed.turns - std::floor(sensed.turns));
    case Register::kVelocity:
      return is(sensed.turns_per_s);
    case Register::kTorque:
    case Register::kTorqueTotal:
      return is(sensed.torque);
    case Register::kCurrentQ:
      return is(sensed.torque / drive_.torque_constant_Nm_per_A);
    case Register::kTorqueP:
      return is(drive_.sign * now.kp * (now.q_des - joint.theta));
    case Register::kTorqueD:
      return is(drive_.sign * now.kd * (now.v_des - joint.theta_dot));
    case Register::kTorqueFeedForward:
      return is(drive_.sign * now.tau_ff);
    case Register::kCurrentD:
    case Register::kTorqueI:
    case Register::kTrajectoryComplete:
      return is(0.0);
    case Register::kHomeState:
      return is(kHomedOutput);
    case Register::kMotorTemperature:
    case Register::kTemperature:
      return is(kBoardTemperature_degC);
    case Register::kVoltage:
      return is(kVoltage_V);
    case Register::kFault:
      return is(fault_);
    case Register::kMilliseconds:
      return is(static_cast<double>(now_ns_ / 1'000'000));
    case Register::kModel:
      return is(kModel);
    case Register::kFirmware:
      return is(kFirmware);
    case Register::kRegisterMap:
      return is(moteus::kRegisterMapVersion);
    case Register::kId:
      return is(id_);
    default:
      return false;
  }
}

// --- modes ---------------------------------------------------------------------------------------

void MoteusNode::change_mode(Mode wanted, const JointReading& joint) noexcept {
  const bool latched = mode_ == Mode::kFault || mode_ == Mode::kTimeout;
  if (wanted == Mode::kStopped) {
    if (!has(scenario_event_t::FAULT_DRIVE_ERROR)) leave(Mode::kStopped, 0);
  } else if (wanted == Mode::kPosition && !latched) {
    if (mode_ == Mode::kStopped) {
      mode_ = Mode::kEnabling;
      enabling_ns_ = now_ns_;
    }
    command_ = written_;
    command_ns_ = now_ns_;
    const double position = command_.get(Register::kCommandPosition);
    start_turns_ = std::isnan(position) ? sense(joint).turns : position;
  }
}

void MoteusNode::leave(Mode mode, int fault) noexcept {
  mode_ = mode;
  fault_ = fault;
  command_.reset();
}

double MoteusNode::watchdog_s() const noexcept {
  const double asked = command_.get(Register::kCommandWatchdog);
  return asked == 0.0 ? kConfiguredWatchdog_s : asked;
}

void MoteusNode::update(const JointReading&, std::int64_t now_ns) noexcept {
  now_ns_ = now_ns;
  if (mode_ < Mode::kEnabling || mode_ > Mode::kPosition) return;
  // NaN never expires.
  if (static_cast<double>(now_ns - command_ns_) * 1e-9 > watchdog_s()) {
    leave(Mode::kTimeout, 0);
  } else if (mode_ != Mode::kPosition) {
    const std::int64_t passed = (now_ns - enabling_ns_) / kEnablingMode_ns;
    mode_ = passed >= 3 ? Mode::kPosition : static_cast<Mode>(2 + passed);
  }
}

double MoteusNode::wanted_turns() const noexcept {
  const double since_s = static_cast<double>(now_ns_ - command_ns_) * 1e-9;
  return start_turns_ + since_s * command_.get(Register::kCommandVelocity);
}

DriveLaw MoteusNode::law() const noexcept {
  DriveLaw law;
  if (mode_ == Mode::kTimeout && drive_.watchdog_reaction == NodeWatchdogReaction::kDamp) {
    law.kd = drive_.range.kd_Nms_per_rad;
    law.limit = std::min(drive_.peak_torque_Nm, drive_.timeout_torque_Nm);
  }
  if (mode_ != Mode::kPosition) return law;
  const double most = command_.get(Register::kCommandMaxTorque);
  const double kp_scale = command_.get(Register::kCommandKpScale);
  const double kd_scale = std::min(kp_scale, command_.get(Register::kCommandKdScale));
  const double speed = kTurn_rad * command_.get(Register::kCommandVelocity);
  const double kp = kp_scale * drive_.range.kp_Nm_per_rad;
  const double kd = kd_scale * drive_.range.kd_Nms_per_rad;
  law.limit = most >= 0.0 ? std::min(drive_.peak_torque_Nm, most) : drive_.peak_torque_Nm;
  law.tau_ff = drive_.sign * command_.get(Register::kCommandTorque);
  if (has(scenario_event_t::FAULT_FROZEN_ENCODER)) {
    // The loop runs on the frozen reading, which no longer depends on the joint.
    law.tau_ff += drive_.sign * (kp * kTurn_rad * (wanted_turns() - frozen_turns_) + kd * speed);
    return law;
  }
  law.kp = kp;
  law.kd = kd;
  law.q_des = drive_.sign * (kTurn_rad * (wanted_turns() - zero_turns_) - drive_.offset_rad);
  law.v_des = drive_.sign * speed;
  return law;
}

// --- faults --------------------------------------------------------------------------------------

void MoteusNode::on_fault(int fault, const JointReading& joint) noexcept {
  if (fault == scenario_event_t::FAULT_FROZEN_ENCODER) frozen_turns_ = sense(joint).turns;
  if (fault == scenario_event_t::FAULT_DRIVE_ERROR) leave(Mode::kFault, kDriverFault);
}

}  // namespace limber::sim
