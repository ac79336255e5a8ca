// Checks the numbers of a URDF as text: "1,5" is no mass. Tells what counts for one chain from what
// does not.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "robots/loader/urdf_inertial.h"
#include "robots/loader/urdf_limits.h"
#include "robots/loader/urdf_use.h"

namespace limber {

struct UrdfText {
  std::map<std::string, UrdfLimits> limits;  ///< of the joints that move, by name
  /// Complaints of joints whose limits are absent or zero; such a limit counts as none.
  std::vector<std::string> placeholders;
  std::vector<UnphysicalLink> unphysical;  ///< among the links that move
  std::vector<std::string> notes;          ///< "file:line: where: what"
};

/// Throws ConfigError with every complaint of what counts, one a line. What is wrong elsewhere is a
/// note. `ignored`: joints whose <limit> does not count either. Set-up only.
UrdfText check_urdf(const UrdfTree& tree, const UrdfUse& use, const std::set<std::string>& ignored);

}  // namespace limber
