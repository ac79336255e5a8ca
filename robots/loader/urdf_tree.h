// Checks that the joints of a URDF connect its links to one tree.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/complaints.h"

namespace limber {

struct UrdfJointText {
  std::string name;
  std::string parent;
  std::string child;
  int line = 0;
};

/// Complains of unknown links, links with two parents, loops, no root, several roots.
void check_urdf_tree(const std::map<std::string, int>& link_lines,
                     const std::vector<UrdfJointText>& joints, Complaints* complaints);

}  // namespace limber
