// Poses, joints and inertias of the URDF library as KDL's.
#pragma once

#include <urdf_model/link.h>

#include <kdl/frames.hpp>
#include <kdl/joint.hpp>
#include <kdl/rigidbodyinertia.hpp>
#include <string>
#include <vector>

namespace limber {

KDL::Frame to_kdl(const urdf::Pose& pose);

/// Axis normalised; joints of a fixed type, or any other that is not in an arm, become fixed.
KDL::Joint to_kdl(const urdf::Joint& joint);

bool moves(const urdf::Joint& joint);

/// A link with all that hangs from it, as one rigid body in link axes.
struct Load {
  KDL::RigidBodyInertia inertia = KDL::RigidBodyInertia::Zero();
  double branch_mass_kg = 0.0;      ///< what hangs from it, without itself
  std::vector<std::string> frozen;  ///< moving joints in what hangs from it, held at zero
};

/// Everything below `link` but the branch that starts with link `next` (nullptr: everything).
Load load_of(const urdf::Link& link, const urdf::Link* next);

}  // namespace limber
