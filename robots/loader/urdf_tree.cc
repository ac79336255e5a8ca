#include "robots/loader/urdf_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/complaints.h"
#include "common/names.h"
#include "common/suggest.h"
#include "robots/loader/urdf_file.h"

namespace limber {
namespace {

const std::vector<std::string> kJointTypes = {"revolute", "continuous", "prismatic",
                                              "fixed",    "floating",   "planar"};

/// The name attribute, or empty after a complaint. `lines`: where names were taken.
std::string name_of(const XmlElement& element, std::map<std::string, int>* lines,
                    Complaints* complaints) {
  const char* name = element.attribute("name");
  const std::string tag = fmt::format("<{}>", element.name);
  if (name == nullptr || *name == '\0') {
    complaints->add(element.line, tag, "has no name");
    return "";
  }
  if (const std::string problem = shown_name_problem(name); !problem.empty())
    complaints->add(element.line, tag, problem);
  const auto [earlier, added] = lines->emplace(name, element.line);
  if (!added) {
    complaints->add(element.line, tag,
                    fmt::format("the name '{}' is taken by line {}", name, earlier->second));
  }
  return name;
}

std::string link_of(const XmlElement& joint, const char* end, const std::string& where,
                    Complaints* complaints) {
  const XmlElement* element = joint.child(end);
  const char* link = element == nullptr ? nullptr : element->attribute("link");
  const auto same = [&](const XmlElement& child) { return child.name == end; };
  if (std::ranges::count_if(joint.children, same) > 1)
    complaints->add(joint.line, where, fmt::format("<{}> is here twice", end));
  if (link != nullptr && *link != '\0') return link;
  complaints->add(joint.line, where, fmt::format("<{} link=\"...\"/> is missing", end));
  return "";
}

UrdfJointText read_joint_text(const XmlElement& element, std::map<std::string, int>* lines,
                              Complaints* complaints) {
  UrdfJointText joint;
  joint.element = &element;
  joint.line = element.line;
  joint.name = name_of(element, lines, complaints);
  const char* type = element.attribute("type");
  joint.type = type == nullptr ? "" : type;
  const std::string where = fmt::format("joint '{}'", joint.name);
  joint.parent = link_of(element, "parent", where, complaints);
  joint.child = link_of(element, "child", where, complaints);
  return joint;
}

void connect(UrdfTree* tree, Complaints* complaints) {
  std::vector<std::string> names;
  for (const auto& [name, element] : tree->links) names.push_back(name);
  for (std::size_t i = 0; i < tree->joints.size(); ++i) {
    const UrdfJointText& joint = tree->joints[i];
    const std::string where = fmt::format("joint '{}'", joint.name);
    for (const auto& [end, link] :
         {std::pair{"parent", joint.parent}, std::pair{"child", joint.child}}) {
      if (link.empty() || tree->links.contains(link)) continue;
      const std::string near = nearest_word(link, names);
      complaints->add(joint.line, where,
                      fmt::format("{} link '{}' does not exist{}", end, link,
                                  near.empty() ? "" : "; did you mean '" + near + "'?"));
    }
    tree->branches.emplace(joint.parent, i);
    const auto [earlier, added] = tree->above.emplace(joint.child, i);
    if (!added && !joint.child.empty()) {
      complaints->add(joint.line, where,
                      fmt::format("link '{}' already hangs from joint '{}': a loop, or two parents",
                                  joint.child, tree->joints[earlier->second].name));
    }
  }
}

/// Links that no path from the root reaches: they hang from each other in a ring.
std::vector<std::string> unreached(const UrdfTree& tree) {
  std::set<std::string> seen = {tree.root};
  std::vector<std::string> open = {tree.root};
  while (!open.empty()) {
    const std::string link = open.back();
    open.pop_back();
    for (const UrdfJointText* joint : tree.joints_below(link)) {
      if (seen.insert(joint->child).second) open.push_back(joint->child);
    }
  }
  std::vector<std::string> left;
  for (const auto& [name, element] : tree.links) {
    if (!seen.contains(name)) left.push_back(name);
  }
  return left;
}

void find_root(UrdfTree* tree, Complaints* complaints) {
  std::vector<std::string> roots;
  for (const auto& [name, element] : tree->links) {
    if (!tree->above.contains(name)) roots.push_back(name);
  }
  if (roots.size() == 1) tree->root = roots.front();
  if (tree->links.empty()) {
    complaints->add(0, "", "no <link> at all");
  } else if (roots.empty()) {
    complaints->add(0, "", "no root: every link is some joint's child, so the joints form a loop");
  } else if (roots.size() > 1) {
    complaints->add(0, "", "several roots, expected one tree: " + joined(roots));
  } else if (const auto left = unreached(*tree); !left.empty()) {
    complaints->add(
        tree->links.at(left.front())->line, "",
        "not connected to the root '" + roots.front() + "', they form a loop: " + joined(left));
  }
}

}  // namespace

std::string UrdfJointText::type_problem() const {
  if (std::ranges::find(kJointTypes, type) != kJointTypes.end()) return "";
  return fmt::format("type '{}'; expected one of: {}", type, joined(kJointTypes));
}

std::vector<const UrdfJointText*> UrdfTree::joints_below(const std::string& link) const {
  std::vector<const UrdfJointText*> below;
  const auto [first, last] = branches.equal_range(link);
  for (auto branch = first; branch != last; ++branch) below.push_back(&joints[branch->second]);
  return below;
}

UrdfTree read_urdf_tree(const std::string& path) {
  UrdfTree tree;
  tree.file = path;
  tree.robot = std::make_shared<const XmlElement>(read_urdf_file(path));
  Complaints complaints(path);
  std::map<std::string, int> link_lines;
  std::map<std::string, int> joint_lines;
  for (const XmlElement& element : tree.robot->children) {
    if (element.name == "link")
      tree.links.emplace(name_of(element, &link_lines, &complaints), &element);
    if (element.name == "joint")
      tree.joints.push_back(read_joint_text(element, &joint_lines, &complaints));
  }
  connect(&tree, &complaints);
  if (!complaints.any()) find_root(&tree, &complaints);
  complaints.throw_if_any();
  return tree;
}

}  // namespace limber
