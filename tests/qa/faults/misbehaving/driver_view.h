// What the driver of a misbehaving lab is told of its arm. Two programs are linked from one main:
// one with kept_limits.cc and the true gate, one with open_gate.cc in the place of both.
#pragma once

#include "qa/faults/fault_stage.h"
#include "robots/loader/load_robot.h"

namespace limber::misbehaving {

LoadedRobot driver_view(const LoadedRobot& robot);

/// Without the gate: a torque that is no number reaches the bus, where the family would ask for a
/// state in its place.
void send_what_is_no_number(faults::FaultStage* stage);

}  // namespace limber::misbehaving
