// A URDF of nothing but what counts for one chain.
#pragma once

#include <string>

#include "robots/loader/urdf_use.h"

namespace limber {

/// Links with the inertias that move; joints with origin and, of the arm's own, axis. All other
/// joints are fixed; limits are read elsewhere. So nothing else can confuse the URDF library.
std::string reduced_urdf(const UrdfTree& tree, const UrdfUse& use);

}  // namespace limber
