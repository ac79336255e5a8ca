// The <limit> of a joint that moves.
#pragma once

#include <limits>
#include <string>

#include "common/complaints.h"
#include "robots/loader/urdf_tree.h"

namespace limber {

/// Infinite: none. Units: rad, rad/s, N m, or m, m/s, N.
struct UrdfLimits {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  double velocity = std::numeric_limits<double>::infinity();
  double effort = std::numeric_limits<double>::infinity();
};

/// What a `UrdfLimits` is read to, besides its numbers.
struct LimitFindings {
  Complaints* refused;       ///< wrong order, below zero, degrees
  Complaints* placeholders;  ///< absent or zero, as exporters write them: no limit then
};

/// Reads lower, upper, velocity and effort; attributes that are not numbers are left to
/// check_urdf_numbers(). `where` names the joint, as in "joint 'a'".
UrdfLimits read_urdf_limits(const UrdfJointText& joint, const std::string& where,
                            const LimitFindings& findings);

}  // namespace limber
