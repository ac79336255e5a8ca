// The driver's end of one motor, reading whatever the bus brings, in any order with its own
// commands. Of every family: nothing that is not finite comes out, in either direction, no torque
// beyond the joint's limit, and no frame that a bus could not carry.
#pragma once

#include <cmath>

#include "drivers/drive/joint_link.h"
#include "tests/fuzz/support/fuzz_input.h"
#include "tests/fuzz/support/require.h"

namespace limber::fuzz {

inline void require_sane(const JointLink& link) {
  require_finite({link.theta(), link.theta_dot(), link.q(), link.v(), link.tau(), link.current_A(),
                  link.temperature_degC(), link.tau_applied()},
                 "what a drive reports is finite");
}

inline void command_raw(JointLink& link, FuzzInput& input) {
  DriveCommand command;
  for (double* number : {&command.angle_rad, &command.speed_rad_per_s, &command.kp_Nm_per_rad,
                         &command.kd_Nms_per_rad, &command.torque_Nm})
    *number = input.take<double>();
  DriveMemory memory;
  memory.seen.angle_rad = link.theta();
  CanFrame frame;
  DriveCommand sent;
  if (!link.family().codec->command(command, memory, &frame, &sent)) return;
  require(all_finite(command), "a command that is not finite is refused");
  require(all_finite(sent), "what is sent is finite");
  require(is_possible(frame), "a command is a frame that a bus can carry");
  const double limit = link.joint().torque_limit_Nm;
  require(std::abs(sent.torque_Nm) <= limit * (1.0 + 1e-6), "no torque beyond the limit is sent");
}

inline void act(JointLink& link, FuzzInput& input) {
  switch (input.take<std::uint8_t>() % 6) {
    case 0:
      return link.begin_cycle();
    case 1:
      return command_raw(link, input);
    case 2:
      return require(is_possible(link.torque(input.take<double>())), "torque frame");
    case 3:
      return require(is_possible(link.enable()), "enable frame");
    case 4:
      return require(is_possible(link.disable()), "disable frame");
    default:
      require(is_possible(link.clear_error()), "clearing frame");
      require(is_possible(link.state_request()), "request frame");
  }
}

inline void hear(JointLink& link, const CanFrame& frame, std::uint8_t kind, FuzzInput& input) {
  const DriveFamily& family = link.family();
  static_cast<void>(family.intruders->is_foreign_command(frame));
  static_cast<void>(family.startup->is_presence(frame));
  static_cast<void>(family.startup->has_wrong_reply_id(frame));
  if ((kind & 8U) != 0) {
    const int step = input.take<std::uint8_t>() % family.startup->steps();
    double found = 0.0;
    const Answer answer = family.startup->check_answer(step, frame, &found);
    require(is_possible(family.startup->request(step)), "a start-up request can be carried");
    if (answer != Answer::kNone)
      family.startup->describe({family.startup->step(step).reg, answer, found, 0.0});
    return;
  }
  if (!link.is_mine(frame) || link.take_unsolicited(frame)) return;
  const double theta = link.theta();
  const bool taken = link.receive(frame, (kind & 4U) != 0 ? 1 : 0);
  require(taken || link.theta() == theta, "a refused frame changes nothing");
}

inline void fuzz_drive_replies(const JointConfig& joint, bool fd, FuzzInput input) {
  JointLink link(joint, fd, 1e-3, 2);
  while (!input.empty()) {
    const auto kind = input.take<std::uint8_t>();
    if (kind % 4 == 0) {
      act(link, input);
    } else {
      hear(link, input.frame(), kind, input);
    }
    require_sane(link);
  }
}

}  // namespace limber::fuzz
