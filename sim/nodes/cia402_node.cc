#include "sim/nodes/cia402_node.h"

#include <algorithm>
#include <cmath>
#include <limber/scenario_event_t.hpp>
#include <numbers>

#include "sim/nodes/cia402_objects.h"
#include "sim/nodes/encoder_counts.h"

namespace limber::sim {
namespace {

using canopen::SdoAbort;
using cia402::State;

constexpr double kTurn = 2.0 * std::numbers::pi;  // rad
constexpr double kNoMode = 0.0;
constexpr double kMilli = 1e-3;
constexpr double kStanding_rad_per_s = 0.01;
// 605Eh
constexpr int kLetGoInFault = 0;
constexpr int kBrakeInFault = 2;

}  // namespace

Cia402Node::Cia402Node(const JointConfig& joint, bool fd, std::int64_t mode_delay_ns)
    : joint_(joint),
      mode_delay_ns_(mode_delay_ns),
      dictionary_(cia402_objects(joint)),
      node_(&dictionary_, this, canopen::node_of(joint.drive.command_id), fd,
            "limber " + joint.drive.motor),
      loop_(joint.torque_loop),
      rated_torque_Nm_(kMilli * dictionary_.value(cia402::kRatedTorque_mNm)),
      rated_current_A_(kMilli * dictionary_.value(cia402::kRatedCurrent_mA)) {
  apply_settings();
}

// --- frames --------------------------------------------------------------------------------------

bool Cia402Node::receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
                         CanFrame* reply) noexcept {
  reading_ = joint;
  now_ns_ = now_ns;
  const bool deaf = has(scenario_event_t::FAULT_DROP_COMMANDS);
  return node_.receive(frame, now_ns, deaf, reply) && !has(scenario_event_t::FAULT_SILENT);
}

bool Cia402Node::next_frame(CanFrame* frame) noexcept {
  while (node_.next_frame(frame)) {
    if (!has(scenario_event_t::FAULT_SILENT)) return true;
  }
  return false;
}

Cia402Node::Sensed Cia402Node::sense() const noexcept {
  if (has(scenario_event_t::FAULT_FROZEN_ENCODER)) return frozen_;
  const DriveConfig& drive = joint_.drive;
  const auto turns = [&](double angle) { return (drive.sign * angle + drive.offset_rad) / kTurn; };
  const double counts = drive.counts_per_turn;
  const double link_counts = std::ldexp(1.0, joint_.link_encoder.bits);
  return {whole_counts(turns(reading_.theta) * counts),
          std::nearbyint(drive.sign * reading_.theta_dot / kTurn * counts),
          whole_counts(reading_.q / kTurn * link_counts),
          std::nearbyint(reading_.v / kTurn * link_counts)};
}

void Cia402Node::refresh() noexcept {
  const Sensed sensed = sense();
  const double sign = joint_.drive.sign;
  const double torque = joint_.torque_sensor.present
                            ? reading_.joint_torque
                            : reading_.current_A * joint_.drive.torque_constant_Nm_per_A;
  dictionary_.set(cia402::kErrorCode, node_.error_code());
  dictionary_.set(cia402::kStatusword, statusword());
  dictionary_.set(cia402::kModeInForce, mode_in_force_);
  dictionary_.set(cia402::kPosition, sensed.position);
  dictionary_.set(cia402::kVelocity, sensed.velocity);
  dictionary_.set(cia402::kTorqueDemand, demand_permille_);
  dictionary_.set(cia402::kTorqueActual, cia402::to_permille(sign * torque, rated_torque_Nm_));
  dictionary_.set(cia402::kCurrentActual,
                  cia402::to_permille(sign * reading_.current_A, rated_current_A_));
  if (!joint_.link_encoder.present) return;
  dictionary_.set(cia402::kLinkPosition, sensed.link_position);
  dictionary_.set(cia402::kLinkVelocity, sensed.link_velocity);
}

std::uint16_t Cia402Node::statusword() const noexcept {
  unsigned word =
      cia402::statusword_of(machine_.state()) | cia402::kVoltagePresent | cia402::kRemote;
  if (enabled()) word |= cia402::kFollowing | cia402::kTargetReached;
  const bool at_peak = std::abs(motor_torque()) > joint_.drive.peak_torque_Nm;
  if (enabled() && (limited_ || at_peak)) word |= cia402::kLimitActive;
  if (has(scenario_event_t::FAULT_HOT)) word |= cia402::kWarning;
  return static_cast<std::uint16_t>(word);
}

// --- objects -------------------------------------------------------------------------------------

int Cia402Node::option(const cia402::Object& object) noexcept {
  return static_cast<int>(dictionary_.value(object));
}

Refusal Cia402Node::refuses(const DictionaryEntry& entry, double value) noexcept {
  if (entry.id == cia402::kMode.id && value != kNoMode && value != cia402::kCyclicSynchronousTorque)
    return SdoAbort::kValueRange;
  if (entry.id == cia402::kFaultOption.id && value != kLetGoInFault && value != kBrakeInFault)
    return SdoAbort::kValueRange;
  if (entry.id == cia402::kSpringStiffness_Nm_per_rad.id && value == 0.0)
    return SdoAbort::kValueRange;
  return {};
}

void Cia402Node::on_written(canopen::ObjectId id) noexcept {
  if (id == cia402::kControlword.id) apply_controlword();
  if (id == cia402::kMode.id) mode_wanted_ns_ = now_ns_;
  if (id.index == cia402::kInertiaRatio.id.index) apply_settings();
  apply_demand();
}

void Cia402Node::apply_controlword() noexcept {
  const State before = machine_.state();
  machine_.on_controlword(static_cast<std::uint16_t>(dictionary_.value(cia402::kControlword)),
                          option(cia402::kQuickStopOption),
                          !has(scenario_event_t::FAULT_DRIVE_ERROR));
  const State after = machine_.state();
  if (before == State::kFault && after != State::kFault) node_.clear_errors();
  if (before == State::kOperationEnabled || after != State::kOperationEnabled) return;
  dictionary_.set(cia402::kTargetTorque, 0.0);
  dictionary_.set(cia402::kTorqueOffset, 0.0);
}

void Cia402Node::apply_settings() noexcept {
  const double stiffness = dictionary_.value(cia402::kSpringStiffness_Nm_per_rad);
  const double damping = dictionary_.value(cia402::kSpringDamping_Nms_per_rad);
  loop_.set(dictionary_.value(cia402::kInertiaRatio), stiffness > 0.0 ? damping / stiffness : 0.0);
}

void Cia402Node::apply_demand() noexcept {
  const double wanted =
      dictionary_.value(cia402::kTargetTorque) + dictionary_.value(cia402::kTorqueOffset);
  const double most = std::min(dictionary_.value(cia402::kMaxTorque), 32767.0);
  demand_permille_ = std::clamp(wanted, -most, most);
  limited_ = demand_permille_ != wanted;
}

// --- firmware ------------------------------------------------------------------------------------

void Cia402Node::update(const JointReading& joint, std::int64_t now_ns) noexcept {
  reading_ = joint;
  now_ns_ = now_ns;
  if (joint_.torque_sensor.present) loop_.update(joint_.drive.sign * joint.joint_torque, now_ns);
  if (now_ns - mode_wanted_ns_ >= mode_delay_ns_) mode_in_force_ = dictionary_.value(cia402::kMode);
  machine_.update(now_ns, std::abs(joint.theta_dot) < kStanding_rad_per_s,
                  option(cia402::kQuickStopOption));
  node_.update(now_ns);
}

double Cia402Node::loop_rate_hz() const noexcept {
  return joint_.torque_sensor.present ? joint_.torque_loop.rate_hz : 0.0;
}

bool Cia402Node::enabled() const noexcept {
  return machine_.state() == State::kOperationEnabled &&
         mode_in_force_ == cia402::kCyclicSynchronousTorque;
}

double Cia402Node::motor_torque() const noexcept {
  return loop_.torque(kMilli * demand_permille_ * rated_torque_Nm_);
}

DriveLaw Cia402Node::law() const noexcept {
  DriveLaw law;
  const bool shorted =
      machine_.state() == State::kQuickStopActive || (machine_.failed() && braking_);
  law.passive_damping = shorted ? joint_.drive.short_circuit_damping_Nms : 0.0;
  if (!enabled()) return law;
  law.tau_ff = joint_.drive.sign * motor_torque();
  law.limit = joint_.drive.peak_torque_Nm;
  return law;
}

// --- faults --------------------------------------------------------------------------------------

void Cia402Node::fail(bool can_brake) noexcept {
  machine_.fail(now_ns_);
  braking_ = can_brake && option(cia402::kFaultOption) == kBrakeInFault;
}

void Cia402Node::on_connection_lost(std::uint16_t code) noexcept {
  if (machine_.state() != State::kOperationEnabled) return;
  switch (static_cast<cia402::Reaction>(option(cia402::kConnectionLostOption))) {
    case cia402::Reaction::kFault:
      fail(true);
      return node_.raise(code, canopen::kErrorCommunication);
    case cia402::Reaction::kDisableVoltage:
      return machine_.disable_voltage();
    case cia402::Reaction::kQuickStop:
      return machine_.quick_stop(option(cia402::kQuickStopOption));
    case cia402::Reaction::kNothing:
      return;
  }
}

void Cia402Node::on_reset() noexcept {
  machine_.reset();
  mode_in_force_ = kNoMode;
  apply_settings();
  apply_demand();
}

void Cia402Node::on_fault(int fault, const JointReading& joint) noexcept {
  if (fault == scenario_event_t::FAULT_FROZEN_ENCODER) {
    reading_ = joint;
    frozen_ = sense();
    frozen_.velocity = frozen_.link_velocity = 0.0;
  }
  if (fault == scenario_event_t::FAULT_DRIVE_ERROR) {
    fail(false);
    node_.raise(canopen::kOverCurrent, canopen::kErrorCurrent);
  }
}

}  // namespace limber::sim
