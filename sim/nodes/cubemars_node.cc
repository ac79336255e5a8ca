#include "sim/nodes/cubemars_node.h"

#include <algorithm>
#include <cmath>
#include <limber/scenario_event_t.hpp>

#include "sim/nodes/five_numbers.h"

namespace limber::sim {
namespace {

constexpr std::int64_t kZeroing_ns = 1'200'000'000;
constexpr std::uint8_t kCubemarsOverCurrent = 2;

}  // namespace

double CubemarsNode::position(const JointReading& joint) const noexcept {
  if (has(scenario_event_t::FAULT_FROZEN_ENCODER)) return frozen_position_;
  return counted_angle(drive_, joint.theta) + zero_;
}

bool CubemarsNode::receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
                           CanFrame* reply) noexcept {
  now_ns_ = now_ns;
  const bool v3 = drive_.board == cubemars::kV3;
  if (!cubemars::is_to(frame, drive_) || frame.remote || frame.fd || (!v3 && frame.length != 8) ||
      now_ns < deaf_until_ns_)
    return false;
  const bool frozen = has(scenario_event_t::FAULT_FROZEN_ENCODER);
  *reply = cubemars::encode_state({position(joint), frozen ? 0.0 : drive_.sign * joint.theta_dot,
                                   drive_.sign * joint.motor_torque,
                                   static_cast<int>(std::lround(temperature_degC(drive_))), error_},
                                  drive_, mit::Quantiser::kTruncate);
  if (!has(scenario_event_t::FAULT_DROP_COMMANDS)) obey(frame, joint);
  return now_ns >= deaf_until_ns_ && !has(scenario_event_t::FAULT_SILENT);
}

/// Of a V3's modes besides MIT only that without current is emulated.
void CubemarsNode::obey(const CanFrame& frame, const JointReading& joint) noexcept {
  const bool v3 = drive_.board == cubemars::kV3;
  mit::Special special{};
  mit::Command command;
  if (cubemars::decode_command(frame, drive_, &command)) {
    if (v3) switch_on(true);
    if (on_) command_ = command;
    return;
  }
  const bool known = !v3 && mit::decode_special(frame, &special);
  const std::uint32_t packet = v3 ? frame.id & ~0xFFU : 0;
  if (packet == cubemars::kOrigin || (known && special == mit::Special::kSetZero)) {
    zero_ -= position(joint);
    deaf_until_ns_ = now_ns_ + kZeroing_ns;
  } else if (packet == cubemars::kCurrent || (known && special == mit::Special::kDisable)) {
    switch_on(false);
  } else if (known && special == mit::Special::kEnable) {
    switch_on(true);
  }
}

void CubemarsNode::switch_on(bool on) noexcept {
  const bool may = on && error_ == 0;
  if (!may || !on_) command_ = {};
  on_ = may;
}

void CubemarsNode::update(const JointReading& /*joint*/, std::int64_t now_ns) noexcept {
  now_ns_ = now_ns;
  if (!has(scenario_event_t::FAULT_DRIVE_ERROR)) error_ = 0;
}

DriveLaw CubemarsNode::law() const noexcept {
  if (!on_) return {};
  return law_of(
      command_, drive_, zero_,
      has(scenario_event_t::FAULT_FROZEN_ENCODER) ? std::optional(frozen_position_) : std::nullopt,
      most_torque(drive_, drive_.range));
}

void CubemarsNode::on_fault(int fault, const JointReading& joint) noexcept {
  if (fault == scenario_event_t::FAULT_FROZEN_ENCODER) frozen_position_ = position(joint);
  if (fault != scenario_event_t::FAULT_DRIVE_ERROR) return;
  error_ = kCubemarsOverCurrent;
  switch_on(false);
}

}  // namespace limber::sim
