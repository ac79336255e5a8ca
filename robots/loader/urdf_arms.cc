#include "robots/loader/urdf_arms.h"

#include <algorithm>
#include <set>

namespace limber {
namespace {

/// A joint that follows another one is no joint of an arm.
bool follows(const UrdfJointText& joint) { return joint.element->child("mimic") != nullptr; }

std::vector<const UrdfJointText*> independent_below(const UrdfTree& tree, const std::string& link) {
  auto below = tree.joints_below(link);
  std::erase_if(below, [](const UrdfJointText* joint) { return follows(*joint); });
  return below;
}

/// Links that have a moving joint somewhere below.
std::set<std::string> links_with_motion_below(const UrdfTree& tree) {
  std::set<std::string> links;
  for (const UrdfJointText& joint : tree.joints) {
    if (!joint.moves() || follows(joint)) continue;
    std::string link = joint.parent;
    while (links.insert(link).second) {
      const UrdfJointText* above = tree.joint_above(link);
      if (above == nullptr) break;
      link = above->parent;
    }
  }
  return links;
}

bool is_end(const UrdfTree& tree, const std::string& link, const std::set<std::string>& moving) {
  const auto below = independent_below(tree, link);
  const auto branches = std::ranges::count_if(below, [&](const UrdfJointText* joint) {
    return joint->moves() || moving.contains(joint->child);
  });
  return below.empty() || branches > 1;
}

void add(const UrdfArm& arm, std::vector<UrdfArm>* arms) {
  const auto same = std::ranges::find_if(*arms, [&](const UrdfArm& other) {
    return other.base == arm.base && other.joints == arm.joints;
  });
  if (same == arms->end()) {
    arms->push_back(arm);
  } else {
    same->also.push_back(same->tip);
    same->tip = arm.tip;
  }
}

}  // namespace

std::vector<UrdfArm> find_arms(const UrdfTree& tree) {
  const std::set<std::string> moving = links_with_motion_below(tree);
  std::vector<UrdfArm> arms;
  std::vector<UrdfArm> open = {{tree.root, tree.root, {}, {}}};  // depth first
  while (!open.empty()) {
    const UrdfArm here = open.back();
    open.pop_back();
    if (!here.joints.empty() && is_end(tree, here.tip, moving)) add(here, &arms);
    const auto below = independent_below(tree, here.tip);
    for (auto joint = below.rbegin(); joint != below.rend(); ++joint) {
      UrdfArm next = here;
      next.tip = (*joint)->child;
      if ((*joint)->type == "floating" || (*joint)->type == "planar") {
        next = {next.tip, next.tip, {}, {}};
      } else if ((*joint)->moves()) {
        next.joints.push_back((*joint)->name);
      }
      open.push_back(next);
    }
  }
  return arms;
}

}  // namespace limber
