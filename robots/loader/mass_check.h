// Refuses an arm that cannot be simulated or controlled because a joint moves no mass.
#pragma once

#include <string>

#include "robots/loader/load_robot.h"

namespace limber {

/// The mass matrix M(q) must be positive definite at home and at a few seeded poses within the
/// limits. Throws ConfigError naming the joint. Set-up only.
void check_mass_matrix(const LoadedRobot& robot, const std::string& file);

}  // namespace limber
