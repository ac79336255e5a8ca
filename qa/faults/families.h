// An arm of each family of drives, for the faults: one row a family.
#pragma once

#include <span>
#include <string_view>

#include "drivers/can/can_frame.h"
#include "qa/faults/state_change.h"

namespace limber::faults {

struct Family {
  std::string_view protocol;
  const char* robot;
  /// with_motion() of one family; the time stamp need not stay.
  CanFrame (*with_motion)(const CanFrame& reply, const JointConfig& joint, bool fd,
                          const MotionChange& change);
};

std::span<const Family> families();
const Family& family_of(const DriveConfig& drive);

// In state_change.cc.
CanFrame with_motion_of_damiao(const CanFrame& reply, const JointConfig& joint, bool fd,
                               const MotionChange& change);
CanFrame with_motion_of_moteus(const CanFrame& reply, const JointConfig& joint, bool fd,
                               const MotionChange& change);
CanFrame with_motion_of_cia402(const CanFrame& reply, const JointConfig& joint, bool fd,
                               const MotionChange& change);
CanFrame with_motion_of_robstride(const CanFrame& reply, const JointConfig& joint, bool fd,
                                  const MotionChange& change);
CanFrame with_motion_of_myactuator(const CanFrame& reply, const JointConfig& joint, bool fd,
                                   const MotionChange& change);
CanFrame with_motion_of_cubemars(const CanFrame& reply, const JointConfig& joint, bool fd,
                                 const MotionChange& change);
CanFrame with_motion_of_odrive(const CanFrame& reply, const JointConfig& joint, bool fd,
                               const MotionChange& change);

}  // namespace limber::faults
