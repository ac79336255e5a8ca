// From the tree of a URDF to the one chain limber controls.
#pragma once

#include <urdf_world/types.h>

#include <kdl/chain.hpp>
#include <set>
#include <string>
#include <vector>

#include "robots/loader/robot.h"
#include "robots/loader/urdf_text.h"

namespace limber {

/// Base to tip, with everything else of the tree carried along.
struct UrdfChain {
  std::shared_ptr<const urdf::ModelInterface> model;  ///< all of the tree, see urdf_model()
  KDL::Chain chain;
  std::vector<std::string> segment_links;  ///< link at the end of each segment
  std::vector<JointConfig> joints;         ///< moving joints with the URDF's limits
  KDL::Rotation R_RB;                      ///< base axes in axes of the URDF's root link
  std::vector<std::string> placeholders;   ///< see UrdfText
  std::vector<UnphysicalLink> unphysical;  ///< likewise
  std::vector<std::string> notes;
};

/// Reads a URDF and builds the chain from base to tip. Side branches, and all that lies beyond the
/// tip, are added to the link they hang from (Ic' = Ic + parallel axes), their joints frozen at
/// zero; so are moving joints between root and base. `ignored`: joints whose <limit> does not
/// count. Throws ConfigError, see read_urdf_tree(), find_use() and check_urdf(). Set-up only.
UrdfChain build_urdf_chain(const std::string& path, const std::string& base, const std::string& tip,
                           const std::set<std::string>& ignored);

}  // namespace limber
