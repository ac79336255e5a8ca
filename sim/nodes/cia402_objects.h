// The object dictionary of an emulated CiA 402 drive, without CANopen's own objects.
#pragma once

#include "robots/loader/robot.h"
#include "sim/nodes/canopen_dictionary.h"

namespace limber::sim {

/// As the drive comes from whoever has configured it for this joint; not closed yet. Objects of
/// sensors that the joint does not have do not exist, and without a torque sensor the torque loop
/// is read only.
CanopenDictionary cia402_objects(const JointConfig& joint);

}  // namespace limber::sim
