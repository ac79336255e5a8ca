// A plate with a round blind hole, its mouth chamfered by 45 degrees, as a ball meets it.
//
// All is round about the hole's axis, so the plate is a convex corner in the plane of the radius
// rho and the height z over the face:  z <= 0,  rho >= R,  rho - z >= R + c,  and the floor z <=
// -d.
#pragma once

#include "sim/world/ball_contact.h"

namespace limber::sim {

/// Base axes. Allowed in the cycle.
struct Hole {
  Eigen::Vector3d mouth = Eigen::Vector3d::Zero();    ///< centre, on the face
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< of the face, towards free space
  double radius = 0.0;                                ///< R, m
  double chamfer = 0.0;                               ///< c, m
  double depth = 0.0;                                 ///< d, m

  /// Of a ball at p: plate and floor.
  Touches touches(const Eigen::Vector3d& p, double ball_radius) const noexcept;
};

}  // namespace limber::sim
