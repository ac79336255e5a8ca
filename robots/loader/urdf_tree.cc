#include "robots/loader/urdf_tree.h"

#include <fmt/format.h>

#include <set>

#include "common/suggest.h"

namespace limber {
namespace {

std::vector<std::string> names(const std::map<std::string, int>& lines) {
  std::vector<std::string> list;
  list.reserve(lines.size());
  for (const auto& [name, line] : lines) list.push_back(name);
  return list;
}

/// Links that no path from the root reaches: they hang from each other in a ring.
std::vector<std::string> unreached(const std::string& root,
                                   const std::map<std::string, int>& link_lines,
                                   const std::vector<UrdfJointText>& joints) {
  std::multimap<std::string, std::string> children;
  for (const UrdfJointText& joint : joints) children.emplace(joint.parent, joint.child);
  std::set<std::string> seen = {root};
  std::vector<std::string> open = {root};
  while (!open.empty()) {
    const std::string link = open.back();
    open.pop_back();
    const auto [first, last] = children.equal_range(link);
    for (auto child = first; child != last; ++child) {
      if (seen.insert(child->second).second) open.push_back(child->second);
    }
  }
  std::vector<std::string> left;
  for (const auto& [name, line] : link_lines) {
    if (!seen.contains(name)) left.push_back(name);
  }
  return left;
}

}  // namespace

void check_urdf_tree(const std::map<std::string, int>& link_lines,
                     const std::vector<UrdfJointText>& joints, Complaints* complaints) {
  if (link_lines.empty()) {
    complaints->add(0, "", "no <link> at all");
    return;
  }
  std::map<std::string, std::string> parent_joint;
  for (const UrdfJointText& joint : joints) {
    const std::string where = fmt::format("joint '{}'", joint.name);
    for (const auto& [end, link] :
         {std::pair{"parent", joint.parent}, std::pair{"child", joint.child}}) {
      if (link.empty() || link_lines.contains(link)) continue;
      const std::string near = nearest_word(link, names(link_lines));
      complaints->add(joint.line, where,
                      fmt::format("{} link '{}' does not exist{}", end, link,
                                  near.empty() ? "" : "; did you mean '" + near + "'?"));
    }
    const auto [earlier, added] = parent_joint.emplace(joint.child, joint.name);
    if (!added && !joint.child.empty()) {
      complaints->add(joint.line, where,
                      fmt::format("link '{}' already hangs from joint '{}': a loop, or two parents",
                                  joint.child, earlier->second));
    }
  }
  if (complaints->any()) return;
  std::vector<std::string> roots;
  for (const auto& [name, line] : link_lines) {
    if (!parent_joint.contains(name)) roots.push_back(name);
  }
  if (roots.empty()) {
    complaints->add(0, "", "no root: every link is some joint's child, so the joints form a loop");
  } else if (roots.size() > 1) {
    complaints->add(0, "", "several roots, expected one tree: " + joined(roots));
  } else if (const auto left = unreached(roots.front(), link_lines, joints); !left.empty()) {
    complaints->add(
        link_lines.at(left.front()), "",
        "not connected to the root '" + roots.front() + "', they form a loop: " + joined(left));
  }
}

}  // namespace limber
