#include "sim/nodes/robstride_node.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limber/scenario_event_t.hpp>

#include "sim/nodes/five_numbers.h"

namespace limber::sim {
namespace {

using robstride::Mode;
using robstride::Parameter;
using robstride::Type;

constexpr std::int64_t kTimeoutCount_ns = 50'000;
constexpr std::int64_t kFirstReport_ns = 10'000'000;
constexpr std::int64_t kReportStep_ns = 5'000'000;
constexpr double kSupply_V = 48.0;
constexpr std::uint8_t kMostRunMode = 5;
constexpr std::uint32_t kReportedOverCurrent = 1U << 16U;

std::uint32_t bits(double value) noexcept {
  return std::bit_cast<std::uint32_t>(static_cast<float>(value));
}

}  // namespace

RobstrideNode::RobstrideNode(const JointConfig& joint)
    : drive_(joint.drive), number_(static_cast<std::uint8_t>(joint.drive.command_id)) {}

double RobstrideNode::position(const JointReading& joint) const noexcept {
  if (has(scenario_event_t::FAULT_FROZEN_ENCODER)) return frozen_position_;
  return counted_angle(drive_, joint.theta) + zero_;
}

robstride::State RobstrideNode::state(const JointReading& joint) const noexcept {
  const bool frozen = has(scenario_event_t::FAULT_FROZEN_ENCODER);
  return {number_,
          host_,
          mode_,
          faults_,
          position(joint),
          frozen ? 0.0 : drive_.sign * joint.theta_dot,
          drive_.sign * joint.motor_torque,
          temperature_degC(drive_)};
}

bool RobstrideNode::receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
                            CanFrame* reply) noexcept {
  now_ns_ = now_ns;
  seen_ = joint;
  robstride::Id id{};
  if (!robstride::split(frame, &id) || id.target != number_) return false;
  if (id.type == Type::kState || id.type == Type::kFault) return false;  // of another drive
  const auto sender = static_cast<std::uint8_t>(id.data);
  if (id.type != Type::kControl) host_ = sender;
  robstride::ParameterRequest request;
  if (id.type == Type::kPing || id.type == Type::kSetId || id.type == Type::kSetBaud) {
    // The answer to a new number already has it.
    const bool deaf = has(scenario_event_t::FAULT_DROP_COMMANDS);
    const auto wanted = static_cast<std::uint8_t>(id.data >> 8U);
    const bool valid = wanted >= 1 && wanted <= robstride::kLastMotor;
    if (id.type == Type::kSetId && !deaf && valid) number_ = wanted;
    *reply = robstride::encode_presence(number_, number_);
  } else if (id.type == Type::kRead && robstride::decode_parameter_request(frame, &request)) {
    *reply = read(request.index, sender, joint);
  } else {
    *reply = robstride::encode_state(state(joint), drive_.range, Type::kState);
    if (!has(scenario_event_t::FAULT_DROP_COMMANDS)) {
      last_frame_ns_ = now_ns;
      act(id, frame, joint);
    }
  }
  return !has(scenario_event_t::FAULT_SILENT);
}

void RobstrideNode::act(const robstride::Id& id, const CanFrame& frame,
                        const JointReading& joint) noexcept {
  robstride::ParameterRequest request;
  switch (id.type) {
    case Type::kControl:
      if (mode_ == Mode::kRun && run_mode_ == 0)
        static_cast<void>(robstride::decode_command(frame, drive_.range, &command_));
      break;
    case Type::kEnable:
      if (faults_ == 0 && mode_ != Mode::kRun) {
        mode_ = Mode::kRun;
        command_ = {};
        shorted_ = false;
      }
      break;
    case Type::kStop:
      stop(false);
      if (frame.data[0] == robstride::kClear && !has(scenario_event_t::FAULT_DRIVE_ERROR))
        faults_ = 0;
      break;
    case Type::kSetZero:
      if (mode_ != Mode::kRun && frame.data[0] == 1) zero_ -= position(joint);
      break;
    case Type::kReport:
      reports_ = frame.data[6] == 1;
      last_report_ns_ = now_ns_;
      break;
    case Type::kWrite:
      if (robstride::decode_parameter_request(frame, &request)) write(request);
      break;
    default:
      break;  // saved settings, baud and protocol act after a power cycle, which none has here
  }
}

void RobstrideNode::write(const robstride::ParameterRequest& request) noexcept {
  switch (static_cast<Parameter>(request.index)) {
    case Parameter::kRunMode:
      if (mode_ != Mode::kRun && (request.raw & 0xFFU) <= kMostRunMode)
        run_mode_ = static_cast<std::uint8_t>(request.raw);
      break;
    case Parameter::kTimeout:
      timeout_counts_ = request.raw;
      break;
    case Parameter::kReportPeriod:
      report_period_ = static_cast<std::uint16_t>(std::max(request.raw & 0xFFFFU, 1U));
      break;
    default:
      break;
  }
}

CanFrame RobstrideNode::read(std::uint16_t index, std::uint8_t host,
                             const JointReading& joint) const noexcept {
  robstride::ParameterAnswer answer{number_, host, false, index, 0};
  switch (static_cast<Parameter>(index)) {
    case Parameter::kRunMode:
      answer.raw = run_mode_;
      break;
    case Parameter::kPosition:
      answer.raw = bits(position(joint));
      break;
    case Parameter::kVelocity:
      answer.raw = bits(state(joint).velocity_rad_per_s);
      break;
    case Parameter::kVoltage:
      answer.raw = bits(kSupply_V);
      break;
    case Parameter::kReportPeriod:
      answer.raw = report_period_;
      break;
    case Parameter::kTimeout:
      answer.raw = timeout_counts_;
      break;
    default:
      answer.refused = true;
  }
  return robstride::encode_parameter_answer(answer);
}

bool RobstrideNode::next_frame(CanFrame* frame) noexcept {
  if (has(scenario_event_t::FAULT_SILENT)) return false;
  if (fault_to_tell_) {
    fault_to_tell_ = false;
    *frame = robstride::encode_fault(number_, host_, {kReportedOverCurrent, 0});
    return true;
  }
  const std::int64_t period_ns = kFirstReport_ns + (report_period_ - 1) * kReportStep_ns;
  if (!reports_ || now_ns_ - last_report_ns_ < period_ns) return false;
  last_report_ns_ += period_ns;
  *frame = robstride::encode_state(state(seen_), drive_.range, Type::kReport);
  return true;
}

void RobstrideNode::stop(bool shorted) noexcept {
  mode_ = Mode::kReset;
  command_ = {};
  shorted_ = shorted && drive_.watchdog_reaction == NodeWatchdogReaction::kDamp;
}

void RobstrideNode::update(const JointReading& joint, std::int64_t now_ns) noexcept {
  now_ns_ = now_ns;
  seen_ = joint;
  const std::int64_t timeout_ns = timeout_counts_ * kTimeoutCount_ns;
  if (mode_ == Mode::kRun && timeout_ns > 0 && now_ns - last_frame_ns_ > timeout_ns) stop(true);
}

DriveLaw RobstrideNode::law() const noexcept {
  if (mode_ != Mode::kRun)
    return {.passive_damping = shorted_ ? drive_.short_circuit_damping_Nms : 0.0};
  return law_of(
      command_, drive_, zero_,
      has(scenario_event_t::FAULT_FROZEN_ENCODER) ? std::optional(frozen_position_) : std::nullopt,
      most_torque(drive_, drive_.range));
}

void RobstrideNode::on_fault(int fault, const JointReading& joint) noexcept {
  if (fault == scenario_event_t::FAULT_FROZEN_ENCODER) frozen_position_ = position(joint);
  if (fault == scenario_event_t::FAULT_DRIVE_ERROR) {
    stop(true);
    faults_ = robstride::kOverCurrent;
    fault_to_tell_ = true;
  }
}

}  // namespace limber::sim
