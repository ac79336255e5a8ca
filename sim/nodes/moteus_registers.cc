// The registers of an emulated moteus drive: what a subframe reads and writes.
#include <array>
#include <cmath>
#include <span>

#include "sim/nodes/moteus_node.h"

namespace limber::sim {
namespace {

using moteus::Mode;
using moteus::Register;

constexpr double kVoltage_V = 48.0;
constexpr double kModel = 0x0200;
constexpr double kFirmware = 0x0100;
constexpr double kHomedOutput = 2.0;
constexpr unsigned kMostValues = 60;

}  // namespace

void MoteusNode::write(std::uint16_t reg, double value, const JointReading& joint,
                       Request* request) noexcept {
  if (MoteusCommand::has(reg)) {
    written_.set(reg, value);
    return;
  }
  double present = 0.0;
  switch (static_cast<Register>(reg)) {
    case Register::kMode:
      if (!(value >= 0.0 && value <= moteus::kLastMode)) {
        request->refuse(reg, moteus::kUnknownRegister);
        break;
      }
      written_.reset();
      request->wanted = true;
      request->mode = static_cast<Mode>(value);
      break;
    case Register::kSetOutputNearest:
      if (std::isfinite(value)) zero_turns_ += std::round(value - sense(joint).turns);
      break;
    case Register::kSetOutputExact:
      if (std::isfinite(value)) set_output(value, joint);
      break;
    default:
      request->refuse(reg,
                      read(reg, joint, &present) ? moteus::kNotWritable : moteus::kUnknownRegister);
  }
}

void MoteusNode::set_output(double turns, const JointReading& joint) noexcept {
  zero_turns_ += turns - sense(joint).turns;
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
      return is(0.0);
    case Register::kTrajectoryComplete:
      return is(mode_ == Mode::kPosition && setpoint_.complete() ? 1.0 : 0.0);
    case Register::kHomeState:
      return is(kHomedOutput);
    case Register::kMotorTemperature:
    case Register::kTemperature:
      return is(temperature_degC(drive_));
    case Register::kVoltage:
      return is(kVoltage_V);
    case Register::kFault:
      return is(fault_);
    case Register::kAux1GpioStatus:
    case Register::kAux2GpioStatus:
      return is(0.0);  // nothing is wired to its auxiliary ports
    case Register::kMilliseconds:
      return is(static_cast<double>(now_ns_ / 1'000'000));
    case Register::kModel:
      return is(kModel);
    case Register::kFirmware:
      return is(kFirmware);
    case Register::kRegisterMap:
      return is(moteus::kRegisterMapVersion);
    case Register::kId:
      return is(id());
    default:
      return false;
  }
}

}  // namespace limber::sim
