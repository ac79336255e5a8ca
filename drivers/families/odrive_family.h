// ODrive drives in CANSimple: torque alone is commanded, each part of the state is asked for.
#pragma once

#include <numbers>

#include "drivers/families/drive_family.h"
#include "drivers/protocols/odrive.h"

namespace limber {

std::unique_ptr<DriveCodec> odrive_codec(const JointConfig& joint, double period_s);
std::unique_ptr<StartupDialogue> odrive_startup(const JointConfig& joint);
std::unique_ptr<IntruderRules> odrive_intruders(const JointConfig& joint);

inline std::uint32_t odrive_node(const DriveConfig& drive) noexcept {
  return odrive::node_of(drive.command_id);
}
/// Of the motor, a radian of the joint.
inline double odrive_turns_per_rad(const DriveConfig& drive) noexcept {
  return drive.gear_ratio / (2.0 * std::numbers::pi);
}

}  // namespace limber
