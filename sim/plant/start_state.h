// Where motors and springs are when the simulation starts.
#pragma once

#include "robots/loader/robot.h"
#include "sim/plant/arm_plant.h"

namespace limber::sim {

/// The arm at rest at q. Motors of antagonistic joints are wound up to preload_rad and carry the
/// weight. A single motor behind a spring carries it too, unless the arm lies in the stand: then
/// its spring is relaxed, and it winds up against the held link once its drive works. Set-up only.
void start_at(const Robot& robot, const VectorJ& q, bool stand, ArmPlant* plant);

/// The stand at the present state: of all links, and of motors that springs would unwind before
/// their drives work.
void set_stands(const Robot& robot, const ArmState& x, ForceModel* forces) noexcept;

}  // namespace limber::sim
