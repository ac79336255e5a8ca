// All joints of the arm with the one state that their drives share, and the torques on their way to
// them.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <limber/driver_status_t.hpp>
#include <limber/joint_command_t.hpp>
#include <limber/joint_state_t.hpp>
#include <string>
#include <vector>

#include "common/joints.h"
#include "drivers/arm_joint.h"
#include "drivers/drive/bus_end.h"
#include "drivers/drive/drive_state_machine.h"
#include "drivers/drive/rest_torque.h"
#include "drivers/gate/torque_gate.h"
#include "robots/loader/robot.h"

namespace limber {

/// Everything but the constructor and the two configuration_...() is allowed in the cycle.
class ArmDrives {
 public:
  ArmDrives(const Robot& robot, int bridged_cycles);

  // --- state ----------------------------------------------------------------------------------

  void apply(DriveEvent event, int joint = -1) noexcept;
  bool in(DriveState state) const noexcept { return machine_.state() == state; }
  /// Commands sent since the state was entered.
  std::int64_t cycles_in_state() const noexcept { return cycles_in_state_; }
  /// The hand, which is none of the chain, is the last one.
  const std::vector<ArmJoint>& joints() const noexcept { return joints_; }
  bool all_answered() const noexcept { return std::ranges::all_of(joints_, &ArmJoint::answered); }
  bool all_disabled() const noexcept { return std::ranges::all_of(joints_, &ArmJoint::disabled); }
  /// In OFF or FAULT, and every drive reports disabled.
  bool all_off() const noexcept {
    return (in(DriveState::kOff) || in(DriveState::kFault)) && all_disabled();
  }
  /// The drive whose start-up failed and why; empty if none. Allocates: for messages.
  std::string configuration_problem() const;
  /// What drives lack without being wrong, and joints outside their limits; one line each.
  /// Allocates likewise.
  std::vector<std::string> configuration_warnings() const;
  /// What motor 0, 1, .. of the arm, counted along its joints, is to be looked at for.
  DriveWarning warning(int motor) const noexcept;
  /// The same in words. Allocates: for messages.
  std::string warning_text(int motor, const DriveWarning& warning) const;
  /// What a drive's error is, in words: its status code, or a setting that was changed. Allowed in
  /// every thread. Allocates: for messages.
  std::string error_text(std::size_t joint, std::uint16_t status) const;

  /// "joint7 (id 0x7)"; of no joint (-1) the first and the last. Likewise.
  std::string address_text(int joint) const;
  /// How hot a joint is, and its limit, in words. Likewise.
  std::string heat_text(std::size_t joint, int temperature_degC) const;

  // --- towards the drives ---------------------------------------------------------------------

  /// Frames that drives need once a cycle and bus, whoever of them needs it. Set-up only.
  void add_bus_frames(std::vector<BusEnd>* buses) const;
  /// This cycle's one frame for every motor.
  void add_commands(std::vector<BusEnd>* buses) noexcept;
  /// In ON: every kSettingCycles cycles one motor of each bus, in turn, is asked for a setting.
  void ask_for_settings(std::vector<BusEnd>* buses) noexcept;

  /// Cycles without a reply of a joint, of all joints for -1. Allowed in the cycle.
  std::int64_t silent_cycles(int joint) const noexcept;
  /// Before what has come since the last cycle is received.
  void begin_cycle() noexcept;

  // --- from the drives ------------------------------------------------------------------------

  /// What receive() and record_foreign() take of one bus. Allocates: set-up only.
  std::vector<CanFilter> receive_filters(std::size_t bus) const;

  /// A frame of somebody else. Returns the joint whose drive it commands, or whose settings it
  /// writes; -1: none of this arm.
  int record_foreign(std::size_t bus, const CanFrame& frame) noexcept;
  /// False if the frame is of no drive of this arm. `late`: it came after its cycle.
  bool receive(std::size_t bus, const CanFrame& frame, bool late) noexcept;
  /// End of the cycle: replies that are missing now are missing.
  /// `time_s`: arm time of the cycle.
  void close_cycle(std::int64_t cycle, double time_s) noexcept;
  /// After the cycle's last change of state: outside ON, the first step to the controller's torque
  /// counts from what the drives exert by themselves.
  void update_torque_present() noexcept;

  // --- an accepted command --------------------------------------------------------------------

  /// The torques that the drives go on making in FALLBACK.
  void set_gravity(const joint_command_t& command) noexcept;
  /// Executes the request; in ON, the torques leave with the next commands.
  void follow(const joint_command_t& command) noexcept;

  // --- messages -------------------------------------------------------------------------------

  void write_situation(GateSituation* situation) const noexcept;
  void write_state(joint_state_t* state) const noexcept;
  void write_status(driver_status_t* status) const noexcept;

 private:
  bool follows_torque() const noexcept;
  JointTorque held_after(DriveEvent event, std::size_t joint) const noexcept;
  void execute(int request) noexcept;
  void turn_on(bool acknowledge) noexcept;
  void acknowledge() noexcept;
  Drive* sender_of(std::size_t bus, const CanFrame& frame) noexcept;
  const Drive& motor_at(int motor) const noexcept;

  std::vector<ArmJoint> joints_;
  bool has_hand_;  ///< the last of them
  DriveStateMachine machine_;
  std::atomic<bool> enabling_ended_ = false;  ///< by its time-out; read by the thread that logs
  int settling_cycles_;                       ///< FALLBACK: damping before the position is held
  std::int64_t cycles_in_state_ = 0;
  std::array<int, kMaxBuses> motors_on_bus_{};
  std::array<JointTorque, kMaxJoints> torque_{};          ///< accepted last, sent next
  std::array<double, kMaxJoints> tau_gravity_{};          ///< N m, of the command accepted last
  std::vector<RestTorque> rest_torque_;                   ///< of the joints, in ON
  std::array<JointTorque, kMaxJoints> torque_present_{};  ///< sent last, or exerted by the drives
};

}  // namespace limber
