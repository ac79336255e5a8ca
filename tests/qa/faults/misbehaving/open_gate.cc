// In the place of drivers/gate/torque_gate.cc: a gate that accepts everything. And an arm without
// limits for those who come behind it: the families' clamps, the trips of position and speed.
#include <limber/driver_status_t.hpp>
#include <limits>
#include <optional>

#include "driver_view.h"
#include "drivers/gate/torque_gate.h"
#include "drivers/protocols/moteus.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber {

int check_command(const GateLimits&, const GateMemory&, const GateSituation&,
                  const joint_command_t&) noexcept {
  return driver_status_t::VERDICT_ACCEPTED;
}

void TorqueGate::next_cycle() noexcept { ++cycle_; }

int TorqueGate::judge(const joint_command_t& command, const GateSituation& situation) noexcept {
  memory_.controller = command.controller;
  memory_.silent_cycles = 0;
  memory_.state_seq = command.state_seq;
  too_often_ = false;
  return check_command(limits_, memory_, situation, command);
}

namespace misbehaving {

LoadedRobot driver_view(const LoadedRobot& robot) {
  LoadedRobot view = robot;
  for (JointConfig& joint : view.robot.joints) {
    joint.torque_limit_Nm = joint.drive.range.torque_Nm;
    joint.torque_rate_limit_Nm_per_s = 1e6;
    joint.velocity_limit = joint.drive.range.velocity_rad_per_s;
    joint.position_min = -joint.drive.range.position_rad;
    joint.position_max = joint.drive.range.position_rad;
    joint.drive.single_turn = false;
  }
  return view;
}

void send_what_is_no_number(faults::FaultStage* stage) {
  const DriveConfig& drive = stage->joint().drive;
  if (drive.protocol != &protocol_named("moteus")) return;
  moteus::Command command;
  command.position_turns = command.torque_Nm = std::numeric_limits<double>::quiet_NaN();
  command.watchdog_s = drive.watchdog_s;
  stage->bus().set_sent_change(
      [command, id = drive.command_id](const CanFrame& frame) -> std::optional<CanFrame> {
        return has_id(frame, id) ? moteus::encode_command(command, id) : frame;
      });
}

}  // namespace misbehaving
}  // namespace limber
