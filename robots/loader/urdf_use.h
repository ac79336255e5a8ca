// Which parts of a URDF count for one chain.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "robots/loader/urdf_tree.h"

namespace limber {

enum class JointUse {
  kMoves,   ///< a joint of the arm: all of it counts
  kPlaces,  ///< where its child is: between root and base, fixed in the arm, or in what it carries
  kNone,    ///< elsewhere in the file
};

/// What limber takes of a URDF, given the two ends of the arm. Points into the tree.
struct UrdfUse {
  std::string base;
  std::string tip;
  std::vector<const UrdfJointText*> chain;  ///< joints from base to tip, in order
  std::map<std::string, JointUse> joints;   ///< by name; what is absent is kNone
  std::set<std::string> placed_links;       ///< that the joints above connect
  /// Links behind the first moving joint, on the chain or carried by it: their inertias count.
  std::set<std::string> moving_links;

  JointUse of(const UrdfJointText& joint) const {
    const auto found = joints.find(joint.name);
    return found == joints.end() ? JointUse::kNone : found->second;
  }
};

/// Throws ConfigError: base or tip unknown, tip not below base, joint types other than revolute,
/// continuous, prismatic, fixed in the chain, no moving joint or more than 16. Set-up only.
UrdfUse find_use(const UrdfTree& tree, const std::string& base, const std::string& tip);

}  // namespace limber
