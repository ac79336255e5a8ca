// Fills SIM_TRUTH from the arm as it is.
#pragma once

#include <cstdint>
#include <limber/sim_truth_t.hpp>

#include "sim/plant/arm_plant.h"
#include "sim/plant/force_model.h"

namespace limber::sim {

/// All fields but seq and the two times. Forces are those at the present state and simulated time
/// t; friction and end stops are those held over the last step. The plant lends its work space and
/// does not move. Allowed in the cycle.
void fill_truth(const ForceModel& forces, std::int64_t t_ns, ArmPlant* at,
                sim_truth_t* truth) noexcept;

}  // namespace limber::sim
