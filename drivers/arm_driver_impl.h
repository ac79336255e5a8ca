// The insides of ArmDriver: what it keeps, and the steps of its cycle by name.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/joints.h"
#include "drivers/arm_driver.h"
#include "drivers/arm_joint.h"
#include "drivers/bus_end.h"
#include "drivers/drive_states.h"
#include "drivers/gate/torque_gate.h"
#include "drivers/tip_sensor_link.h"

namespace limber {

struct ArmDriver::Impl {
  Impl(const Robot& robot, const std::vector<CanBus*>& can, const ArmDriverOptions& options);

  void apply(DriveEvent event, int joint = -1) noexcept;
  bool all_joints(bool (ArmJoint::*test)() const noexcept) const noexcept {
    return std::all_of(joints.begin(), joints.end(),
                       [test](const ArmJoint& joint) { return (joint.*test)(); });
  }

  // transmit
  void watch_controller() noexcept;
  void watch_shut_down() noexcept;
  void send_commands() noexcept;
  // poll
  void take_frames(bool late) noexcept;
  void take_frame(int bus, const CanFrame& frame, bool late) noexcept;
  Drive* sender_of(int bus, const CanFrame& frame) noexcept;
  // finish_cycle
  std::int64_t cycles_all_silent() const noexcept;
  void supervise() noexcept;
  void supervise_progress() noexcept;
  void supervise_replies() noexcept;
  void supervise_motion() noexcept;
  void describe_state() noexcept;
  void describe_joint(std::size_t i) noexcept;
  void describe_tip_sensor() noexcept;
  // accept
  GateSituation situation() const noexcept;
  void obey(const joint_torque_t& command, bool followed) noexcept;
  void acknowledge() noexcept;

  DriveState state() const noexcept { return machine.state(); }
  bool in(DriveState wanted) const noexcept { return machine.state() == wanted; }

  double rate_hz;
  int drive_watchdog_cycles;  ///< of the slowest drive
  bool lockstep;
  int bridged_cycles;
  std::int64_t session;
  std::vector<ArmJoint> joints;
  std::optional<TipSensorLink> tip_sensor;
  std::vector<BusEnd> buses;
  std::vector<double> load_predicted;
  TorqueGate gate;
  DriveStateMachine machine;

  std::int64_t cycle = -1;
  std::int64_t time_ns = 0;
  int cycles_in_state = 0;  ///< commands sent since the state was entered
  bool heard = false;       ///< a command was accepted since the last transmit
  int unheard_cycles = 0;
  bool shutting_down = false;
  std::array<JointTorque, kMaxJoints> torque{};          ///< accepted last, sent next
  std::array<double, kMaxJoints> tau_gravity{};          ///< of the command accepted last
  std::array<JointTorque, kMaxJoints> torque_present{};  ///< what the drives were told last
  std::array<std::int64_t, 16> verdicts{};
  std::int64_t missing = 0;
  joint_state_t published{};
};

}  // namespace limber
