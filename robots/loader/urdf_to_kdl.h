// Poses, joints and inertias of the URDF library as KDL's.
#pragma once

#include <urdf_model/link.h>

#include <kdl/frames.hpp>
#include <kdl/joint.hpp>
#include <kdl/rigidbodyinertia.hpp>

namespace limber {

KDL::Frame to_kdl(const urdf::Pose& pose);

/// Axis normalised.
KDL::Joint to_kdl(const urdf::Joint& joint);

bool moves(const urdf::Joint& joint);

/// A link with all that hangs from it, as one rigid body in link axes.
struct Load {
  KDL::RigidBodyInertia inertia = KDL::RigidBodyInertia::Zero();
  double branch_mass_kg = 0.0;  ///< what hangs from it, without itself
};

/// Everything below `link` but the branch that starts with link `next` (nullptr: everything).
Load load_of(const urdf::Link& link, const urdf::Link* next);

}  // namespace limber
