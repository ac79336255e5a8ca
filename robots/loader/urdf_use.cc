#include "robots/loader/urdf_use.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/complaints.h"
#include "common/config_error.h"
#include "common/joints.h"
#include "common/suggest.h"

namespace limber {
namespace {

void check_end(const UrdfTree& tree, const std::string& role, const std::string& name) {
  if (tree.links.contains(name)) return;
  std::vector<std::string> links;
  for (const auto& [link, element] : tree.links) links.push_back(link);
  const std::string near = nearest_word(name, links);
  constexpr std::size_t kListed = 100;
  if (links.size() > kListed) links.resize(kListed);
  throw ConfigError::at(
      tree.file, 0, role,
      fmt::format("no link '{}'{}; there are: {}", name,
                  near.empty() ? "" : "; did you mean '" + near + "'?", joined(links)));
}

/// The joints from base to tip.
std::vector<const UrdfJointText*> path(const UrdfTree& tree, const std::string& base,
                                       const std::string& tip) {
  std::vector<const UrdfJointText*> joints;
  for (std::string link = tip; link != base; link = joints.back()->parent) {
    const UrdfJointText* joint = tree.joint_above(link);
    if (joint == nullptr) {
      throw ConfigError::at(tree.file, 0, "tip",
                            fmt::format("link '{}' does not lie below the base '{}'", tip, base));
    }
    joints.push_back(joint);
  }
  std::reverse(joints.begin(), joints.end());
  return joints;
}

void check_types(const UrdfTree& tree, const std::vector<const UrdfJointText*>& chain) {
  Complaints complaints(tree.file);
  for (const UrdfJointText* joint : chain) {
    const std::string where = fmt::format("joint '{}'", joint->name);
    if (const std::string problem = joint->type_problem(); !problem.empty()) {
      complaints.add(joint->line, where, problem);
    } else if (joint->type == "floating" || joint->type == "planar") {
      complaints.add(joint->line, where, "floating and planar joints cannot be part of an arm");
    }
  }
  complaints.throw_if_any();
}

void check_count(const UrdfTree& tree, const UrdfUse& use) {
  const auto moving = static_cast<std::size_t>(
      std::ranges::count_if(use.chain, [](const UrdfJointText* joint) { return joint->moves(); }));
  const std::string between = fmt::format("between '{}' and '{}'", use.base, use.tip);
  if (moving == 0) throw ConfigError::at(tree.file, 0, "", "no moving joint " + between);
  if (moving > kMaxJoints) {
    throw ConfigError::at(
        tree.file, 0, "",
        fmt::format("{} moving joints {}; at most {}", moving, between, kMaxJoints));
  }
}

/// A link that moves, with all that it carries but the chain.
void add_moving(const UrdfTree& tree, const std::string& top, UrdfUse* use) {
  std::vector<std::string> open = {top};  // branches may be thousands of links long
  while (!open.empty()) {
    const std::string link = open.back();
    open.pop_back();
    use->moving_links.insert(link);
    use->placed_links.insert(link);
    for (const UrdfJointText* joint : tree.joints_below(link)) {
      if (use->joints.emplace(joint->name, JointUse::kPlaces).second) open.push_back(joint->child);
    }
  }
}

}  // namespace

UrdfUse find_use(const UrdfTree& tree, const std::string& base, const std::string& tip) {
  check_end(tree, "base", base);
  check_end(tree, "tip", tip);
  UrdfUse use;
  use.base = base;
  use.tip = tip;
  use.chain = path(tree, base, tip);
  check_types(tree, use.chain);
  check_count(tree, use);
  use.placed_links.insert(base);
  for (const UrdfJointText* joint = tree.joint_above(base); joint != nullptr;
       joint = tree.joint_above(joint->parent)) {
    use.joints.emplace(joint->name, JointUse::kPlaces);
    use.placed_links.insert(joint->parent);
  }
  for (const UrdfJointText* joint : use.chain) {
    use.joints.emplace(joint->name, joint->moves() ? JointUse::kMoves : JointUse::kPlaces);
    use.placed_links.insert(joint->child);
  }
  bool moves = false;
  for (const UrdfJointText* joint : use.chain) {
    moves = moves || joint->moves();
    if (moves) add_moving(tree, joint->child, &use);
  }
  return use;
}

}  // namespace limber
