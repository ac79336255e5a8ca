// The links and joints of a URDF file and how they hang together, before any number is read.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "robots/loader/xml_element.h"

namespace limber {

struct UrdfJointText {
  std::string name;
  std::string type;  ///< as in the file
  std::string parent;
  std::string child;
  const XmlElement* element = nullptr;
  int line = 0;

  bool moves() const { return type != "fixed"; }
  /// A complaint if the type is none of the format's; else empty.
  std::string type_problem() const;
};

/// One tree: every link but the root is the child of one joint. Names are unique.
struct UrdfTree {
  std::string file;
  std::shared_ptr<const XmlElement> robot;  ///< the top element; owns the others
  std::map<std::string, const XmlElement*> links;
  std::vector<UrdfJointText> joints;  ///< in file order
  std::string root;
  std::map<std::string, std::size_t> above;          ///< index of the joint above a link
  std::multimap<std::string, std::size_t> branches;  ///< indices of the joints below a link

  /// The joint above a link; nullptr for the root.
  const UrdfJointText* joint_above(const std::string& link) const {
    const auto found = above.find(link);
    return found == above.end() ? nullptr : &joints[found->second];
  }
  /// The joints below a link.
  std::vector<const UrdfJointText*> joints_below(const std::string& link) const;
};

/// Reads a file. Throws ConfigError with every complaint, one a line: names that are missing or
/// taken, joints without a parent or child, unknown links, links with two parents, loops, no root,
/// several roots. Set-up only.
UrdfTree read_urdf_tree(const std::string& path);

}  // namespace limber
