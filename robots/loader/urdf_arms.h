// Which arms a URDF holds, for a user who has not yet chosen base and tip.
#pragma once

#include <string>
#include <vector>

#include "robots/loader/urdf_tree.h"

namespace limber {

/// Moving joints from `base` to `tip`; `also`: other links that hang from the same joints.
struct UrdfArm {
  std::string base;
  std::string tip;
  std::vector<std::string> also;
  std::vector<std::string> joints;
};

/// One for every leaf of the tree, and for every link where moving branches part (a hand with
/// fingers); of those with the same joints one, its tip the farthest. Base is the root, or what the
/// last floating or planar joint moves; nothing behind a joint with <mimic> counts. In order of the
/// tree. Set-up only.
std::vector<UrdfArm> find_arms(const UrdfTree& tree);

}  // namespace limber
