#include "robots/loader/urdf_chain.h"

#include <fmt/format.h>
#include <urdf_model/model.h>

#include "common/config_error.h"
#include "robots/loader/urdf_model.h"
#include "robots/loader/urdf_to_kdl.h"

namespace limber {
namespace {

JointType type_of(const urdf::Joint& joint) {
  if (joint.type == urdf::Joint::CONTINUOUS) return JointType::kContinuous;
  return joint.type == urdf::Joint::PRISMATIC ? JointType::kPrismatic : JointType::kRevolute;
}

JointConfig to_config(const urdf::Joint& joint, const UrdfLimits& limits) {
  JointConfig config;
  config.name = joint.name;
  config.type = type_of(joint);
  config.position_min = limits.lower;
  config.position_max = limits.upper;
  config.velocity_limit = limits.velocity;
  config.torque_limit_Nm = limits.effort;
  return config;
}

KDL::Rotation root_to_base(const UrdfTree& tree, const urdf::ModelInterface& model,
                           const UrdfUse& use) {
  KDL::Rotation R_RB = KDL::Rotation::Identity();
  for (const UrdfJointText* joint = tree.joint_above(use.base); joint != nullptr;
       joint = tree.joint_above(joint->parent)) {
    R_RB = to_kdl(model.getJoint(joint->name)->parent_to_joint_origin_transform).M * R_RB;
  }
  return R_RB;
}

/// The joint above a link, and the link with its load.
void add_segment(const urdf::Link& link, const urdf::Link* next, const UrdfTree& tree,
                 const UrdfText& text, UrdfChain* result) {
  const urdf::Joint& joint = *link.parent_joint;
  if (moves(joint)) result->joints.push_back(to_config(joint, text.limits.at(joint.name)));
  const Load load = load_of(link, next);
  if (load.branch_mass_kg > 0.0) {
    result->notes.push_back(
        ConfigError::at(
            tree.file, tree.links.at(link.name)->line, fmt::format("link '{}'", link.name),
            fmt::format("carries {:.4g} kg of side branches as load", load.branch_mass_kg))
            .what());
  }
  result->chain.addSegment(KDL::Segment(
      link.name, to_kdl(joint), to_kdl(joint.parent_to_joint_origin_transform), load.inertia));
  result->segment_links.push_back(link.name);
}

}  // namespace

UrdfChain build_urdf_chain(const std::string& path, const std::string& base, const std::string& tip,
                           const std::set<std::string>& ignored) {
  const UrdfTree tree = read_urdf_tree(path);
  const UrdfUse use = find_use(tree, base, tip);
  const UrdfText text = check_urdf(tree, use, ignored);
  UrdfChain result;
  result.model = urdf_model(tree, use);
  result.R_RB = root_to_base(tree, *result.model, use);
  for (std::size_t i = 0; i < use.chain.size(); ++i) {
    const bool last = i + 1 == use.chain.size();
    const auto next = last ? nullptr : result.model->getLink(use.chain[i + 1]->child);
    add_segment(*result.model->getLink(use.chain[i]->child), next.get(), tree, text, &result);
  }
  result.placeholders = text.placeholders;
  result.unphysical = text.unphysical;
  result.notes.insert(result.notes.end(), text.notes.begin(), text.notes.end());
  return result;
}

}  // namespace limber
