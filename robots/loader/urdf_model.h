// The checked elements of a URDF as urdfdom's model: the chain is built from it, and tools are
// given it.
#pragma once

#include <urdf_world/types.h>

#include "robots/loader/urdf_use.h"

namespace limber {

/// All links and joints of the file. Joints of the arm have their type and axis; the others are
/// fixed, at zero. Links that move have their inertia. A joint of no effect on the arm is left out
/// if its <origin> is wrong. For a tree that check_urdf() has passed. Set-up only.
std::shared_ptr<const urdf::ModelInterface> urdf_model(const UrdfTree& tree, const UrdfUse& use);

}  // namespace limber
