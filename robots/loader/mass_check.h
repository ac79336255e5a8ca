// Refuses an arm that cannot be simulated or controlled because a joint moves no mass, or less.
#pragma once

#include <string>
#include <vector>

#include "robots/loader/load_robot.h"
#include "robots/loader/urdf_inertial.h"

namespace limber {

/// The mass matrix M(q) must be positive definite at home and at seeded poses within the limits: a
/// few, or 1,000 if some inertias are unphysical. Throws ConfigError naming the joint, or the pose,
/// the smallest eigenvalue and the link that is suspect. Set-up only.
void check_mass_matrix(const LoadedRobot& robot, const std::vector<UnphysicalLink>& unphysical);

}  // namespace limber
