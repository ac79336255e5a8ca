// The angle and the law of drives that take position, velocity, kp, kd and torque in each command.
#pragma once

#include <algorithm>
#include <numbers>
#include <optional>

#include "drivers/protocols/mit.h"
#include "robots/loader/robot.h"
#include "sim/joints/drive_law.h"
#include "sim/nodes/encoder_counts.h"

namespace limber::sim {

/// As the joint sees it. `zero`: of the drive, added to its angle. `frozen`: the reading at which
/// the encoder stands, on which the loop then runs instead of the joint. In the cycle.
inline DriveLaw law_of(const mit::Command& command, const DriveConfig& drive, double zero,
                       std::optional<double> frozen, double limit) noexcept {
  DriveLaw law;
  law.limit = limit;
  law.tau_ff = drive.sign * command.torque_Nm;
  if (frozen) {
    law.tau_ff += drive.sign * (command.kp_Nm_per_rad * (command.position_rad - *frozen) +
                                command.kd_Nms_per_rad * command.velocity_rad_per_s);
    return law;
  }
  law.kp = command.kp_Nm_per_rad;
  law.kd = command.kd_Nms_per_rad;
  law.q_des = drive.sign * (command.position_rad - zero - drive.offset_rad);
  law.v_des = drive.sign * command.velocity_rad_per_s;
  return law;
}

/// What its encoder counts of the motor's angle, as the drive's own, rad.
inline double counted_angle(const DriveConfig& drive, double theta) noexcept {
  const double step = 2.0 * std::numbers::pi / drive.counts_per_turn;
  return whole_counts((drive.sign * theta + drive.offset_rad) / step) * step;
}

/// What the drive's current and the torque field allow.
inline double most_torque(const DriveConfig& drive, const CommandRange& range) noexcept {
  return drive.peak_torque_Nm > 0.0 ? std::min(drive.peak_torque_Nm, range.torque_Nm)
                                    : range.torque_Nm;
}

}  // namespace limber::sim
