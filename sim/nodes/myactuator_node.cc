#include "sim/nodes/myactuator_node.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limber/scenario_event_t.hpp>
#include <limits>
#include <numbers>

#include "robots/loader/protocols/myactuator_series.h"
#include "sim/nodes/five_numbers.h"

namespace limber::sim {
namespace {

using myactuator::Firmware;
using myactuator::Order;

constexpr std::int64_t kMs_ns = 1'000'000;
constexpr std::int64_t kReset_ns = 1100 * kMs_ns;
constexpr std::int64_t kTimedOut_ns = 1000 * kMs_ns;
constexpr std::int64_t kStatus_ns = 100 * kMs_ns;
constexpr double kMyactuatorSupply_V = 48.0;
constexpr std::uint32_t kVersionV42 = 2025070202;  // one that axol's motors have

}  // namespace

MyactuatorNode::MyactuatorNode(const JointConfig& joint)
    : drive_(joint.drive),
      number_(static_cast<int>(joint.drive.command_id - myactuator::kMotionId)),
      next_number_(number_) {}

double MyactuatorNode::position(const JointReading& joint) const noexcept {
  if (has(scenario_event_t::FAULT_FROZEN_ENCODER)) return frozen_position_;
  return counted_angle(drive_, joint.theta) + zero_;
}

CanFrame MyactuatorNode::status_frame() const noexcept {
  return myactuator::encode_status({static_cast<int>(std::lround(temperature_degC(drive_))),
                                    released_, kMyactuatorSupply_V, errors_},
                                   number_);
}

CanFrame MyactuatorNode::motion_frame(const JointReading& joint) const noexcept {
  const bool frozen = has(scenario_event_t::FAULT_FROZEN_ENCODER);
  return myactuator::encode_motion(
      {static_cast<std::uint8_t>(number_), position(joint),
       frozen ? 0.0 : drive_.sign * joint.theta_dot, drive_.sign * joint.motor_torque},
      drive_.range, mit::Quantiser::kTruncate);
}

bool MyactuatorNode::receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
                             CanFrame* reply) noexcept {
  now_ns_ = now_ns;
  const auto number = static_cast<std::uint32_t>(number_);
  const bool motion = myactuator::is_frame(frame, myactuator::kMotionId + number);
  const bool order = myactuator::is_frame(frame, myactuator::kOrderId + number) ||
                     myactuator::is_frame(frame, myactuator::kEveryMotorId);
  if ((!motion && !order) || now_ns < deaf_until_ns_) return false;
  *reply = motion ? motion_frame(joint) : frame;
  reply->id = number + (motion ? myactuator::kMotionAnswerId : myactuator::kAnswerId);
  bool answered = true;
  if (has(scenario_event_t::FAULT_DROP_COMMANDS)) {
    if (order && !myactuator::only_reads(frame.data[0]))
      return !has(scenario_event_t::FAULT_SILENT);
    if (order) answered = obey(frame, joint, reply);
  } else {
    last_frame_ns_ = now_ns;
    if (timed_out_) {
      timed_out_ = false;
      std::copy_n(frame.data.begin(), 8, reply->data.begin());
    } else if (order) {
      answered = obey(frame, joint, reply);
    } else if (errors_ == 0) {
      runs_ = mit::decode_command(frame, drive_.range, &command_) || runs_;
    }
  }
  return answered && !has(scenario_event_t::FAULT_SILENT);
}

bool MyactuatorNode::obey(const CanFrame& frame, const JointReading& joint,
                          CanFrame* reply) noexcept {
  const bool v44 = myactuator::firmware_of(drive_.range) == Firmware::kV44;
  const auto set_value = [&](std::uint32_t value) {
    for (unsigned i = 0; i < 4; ++i)
      reply->data[4 + i] = static_cast<std::uint8_t>(value >> (8 * i));
  };
  switch (static_cast<Order>(frame.data[0])) {
    case Order::kFunction:
      return obey_function(frame);
    case Order::kSetZero:
      next_zero_ = zero_ - position(joint);
      return true;
    case Order::kReset:
      reset(joint);
      return false;
    case Order::kReleaseBrake:
      released_ = errors_ == 0;
      return true;
    case Order::kLockBrake:
    case Order::kOff:
      set_off();
      return true;
    case Order::kAngle:
      *reply = myactuator::encode_angle(position(joint), number_);
      return true;
    case Order::kStatus:
      *reply = status_frame();
      return true;
    case Order::kVersion:
      set_value(v44 ? myactuator::kFirstV44 : kVersionV42);
      return true;
    case Order::kTimeout:
      timeout_ms_ = myactuator::value_of(frame);
      return true;
    case Order::kBitRate:  // this bus has 1 Mbit/s, code 1
      if (frame.data[7] == 0) deaf_until_ns_ = std::numeric_limits<std::int64_t>::max();
      return false;
    case Order::kModel: {
      // "X8S2V10" in one answer, or the block-th five of "RMD-X8-P20".
      const bool blocks = v44 && frame.data[1] == 1;
      std::array<char, 24> text{};
      std::snprintf(text.data(), text.size(), v44 ? "RMD-X%d-P20" : "X%dS2V10",
                    v44 ? std::max(series_with(drive_.range.torque_Nm), 4) : 8);
      const std::size_t first = blocks ? 5U * ((frame.data[2] - 1U) & 3U) : 0;
      for (std::size_t i = blocks ? 3 : 1, k = first; i < 8; ++i, ++k)
        reply->data[i] = static_cast<std::uint8_t>(k < text.size() ? text[k] : 0);
      return true;
    }
    case Order::kTimedOut:
      break;
  }
  return false;
}

bool MyactuatorNode::obey_function(const CanFrame& frame) noexcept {
  const std::uint32_t value = myactuator::value_of(frame);
  switch (static_cast<myactuator::Function>(frame.data[1])) {
    case myactuator::Function::kTellErrors:
      tells_errors_ = value == 1;
      return true;
    case myactuator::Function::kSetNumber:
      if (value >= 1 && value <= myactuator::kLastMotor) next_number_ = static_cast<int>(value);
      return true;
  }
  return false;
}

void MyactuatorNode::set_off() noexcept {
  runs_ = released_ = shorted_ = false;
  command_ = {};
}

void MyactuatorNode::reset(const JointReading& joint) noexcept {
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  set_off();
  deaf_until_ns_ = last_frame_ns_ = now_ns_ + kReset_ns;
  number_ = next_number_;
  zero_ = next_zero_;
  zero_ -= kTurn_rad * std::round(position(joint) / kTurn_rad);
  next_zero_ = zero_;
  tells_errors_ = false;
}

bool MyactuatorNode::next_frame(CanFrame* frame) noexcept {
  if (has(scenario_event_t::FAULT_SILENT) || now_ns_ < deaf_until_ns_) return false;
  if (timed_out_ && now_ns_ >= next_timed_out_ns_) {
    next_timed_out_ns_ = now_ns_ + kTimedOut_ns;
    *frame = myactuator::order_frame(Order::kTimedOut, number_);
    frame->id = myactuator::kAnswerId + static_cast<std::uint32_t>(number_);
    return true;
  }
  if (errors_ == 0 || !tells_errors_ || now_ns_ < next_status_ns_) return false;
  next_status_ns_ = now_ns_ + kStatus_ns;
  *frame = status_frame();
  return true;
}

void MyactuatorNode::update(const JointReading& /*joint*/, std::int64_t now_ns) noexcept {
  now_ns_ = now_ns;
  if (!has(scenario_event_t::FAULT_DRIVE_ERROR)) errors_ = 0;
  if (timeout_ms_ == 0 || timed_out_ || now_ns - last_frame_ns_ <= timeout_ms_ * kMs_ns) return;
  const bool damped = enabled() && drive_.watchdog_reaction == NodeWatchdogReaction::kDamp;
  set_off();
  shorted_ = damped;
  timed_out_ = true;
  next_timed_out_ns_ = now_ns;
}

DriveLaw MyactuatorNode::law() const noexcept {
  if (!enabled()) return {.passive_damping = shorted_ ? drive_.short_circuit_damping_Nms : 0.0};
  return law_of(
      command_, drive_, zero_,
      has(scenario_event_t::FAULT_FROZEN_ENCODER) ? std::optional(frozen_position_) : std::nullopt,
      most_torque(drive_, drive_.range));
}

void MyactuatorNode::on_fault(int fault, const JointReading& joint) noexcept {
  if (fault == scenario_event_t::FAULT_FROZEN_ENCODER) frozen_position_ = position(joint);
  if (fault == scenario_event_t::FAULT_DRIVE_ERROR) {
    set_off();
    errors_ = myactuator::kUnderVoltage;
    next_status_ns_ = now_ns_;
  }
}

}  // namespace limber::sim
