// From the tree of a URDF to the one chain limber controls.
#pragma once

#include <kdl/chain.hpp>
#include <string>
#include <vector>

#include "robots/loader/robot.h"
#include "robots/loader/urdf_text.h"

namespace limber {

/// Base to tip, with everything else of the tree carried along.
struct UrdfChain {
  KDL::Chain chain;
  std::vector<std::string> segment_links;  ///< link at the end of each segment
  std::vector<JointConfig> joints;         ///< moving joints with the URDF's limits
  KDL::Rotation R_RB;                      ///< base axes in axes of the URDF's root link
  std::vector<std::string> notes;
};

/// Builds the chain of a checked URDF. Side branches, and all that lies beyond the tip, are added
/// to the link they hang from (Ic' = Ic + parallel axes), their joints frozen at zero; so are
/// moving joints between root and base. Throws ConfigError: base or tip unknown, tip not below
/// base, joint types other than revolute, continuous, prismatic, fixed in the chain, no moving
/// joint or more than 16, effort or velocity not above zero. Set-up only.
UrdfChain build_urdf_chain(const UrdfText& urdf, const std::string& base, const std::string& tip);

}  // namespace limber
