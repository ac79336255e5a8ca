#include "robots/urdf_chain.h"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/complaints.h"
#include "common/config_error.h"
#include "common/joints.h"
#include "common/suggest.h"

namespace limber {
namespace {

/// What the URDF library would print, kept for our own message.
class Listener : public console_bridge::OutputHandler {
 public:
  Listener() { console_bridge::useOutputHandler(this); }
  ~Listener() override { console_bridge::restorePreviousOutputHandler(); }
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && heard_.empty()) heard_ = text;
  }
  const std::string& heard() const { return heard_; }

 private:
  std::string heard_;
};

urdf::ModelInterfaceSharedPtr parse(const UrdfText& text) {
  Listener listener;
  urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text.text);
  if (!model) {
    throw ConfigError::at(text.file, 0, "", "refused by the URDF library: " + listener.heard());
  }
  return model;
}

KDL::Vector to_kdl(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

KDL::Frame to_kdl(const urdf::Pose& pose) {
  double x = 0.0, y = 0.0, z = 0.0, w = 1.0;
  pose.rotation.getQuaternion(x, y, z, w);
  return {KDL::Rotation::Quaternion(x, y, z, w), to_kdl(pose.position)};
}

/// The URDF gives the tensor about the centre of mass in axes of <inertial><origin>; KDL wants it
/// about the centre of mass in link axes.
KDL::RigidBodyInertia to_kdl(const urdf::Inertial& inertial) {
  const KDL::Frame X_LI = to_kdl(inertial.origin);
  const KDL::RotationalInertia tensor(inertial.ixx, inertial.iyy, inertial.izz, inertial.ixy,
                                      inertial.ixz, inertial.iyz);
  const KDL::RigidBodyInertia turned =
      X_LI.M * KDL::RigidBodyInertia(inertial.mass, KDL::Vector::Zero(), tensor);
  return KDL::RigidBodyInertia(inertial.mass, X_LI.p, turned.getRotationalInertia());
}

bool moves(const urdf::Joint& joint) { return joint.type != urdf::Joint::FIXED; }

struct Load {
  KDL::RigidBodyInertia inertia = KDL::RigidBodyInertia::Zero();
  double branch_mass_kg = 0.0;
  std::vector<std::string> frozen;
};

/// A link with all that hangs from it but `next`, in link axes.
Load load_of(const urdf::LinkConstSharedPtr& link, const urdf::LinkConstSharedPtr& next) {
  Load load;
  if (link->inertial) load.inertia = to_kdl(*link->inertial);
  struct Open {
    urdf::LinkConstSharedPtr link;
    KDL::Frame X_LO;
  };
  std::vector<Open> open;
  auto hang = [&](const urdf::LinkConstSharedPtr& from, const KDL::Frame& X_LF) {
    for (const auto& joint : from->child_joints) {
      if (next && joint->child_link_name == next->name) continue;
      const auto child = std::find_if(
          from->child_links.begin(), from->child_links.end(),
          [&](const auto& candidate) { return candidate->name == joint->child_link_name; });
      open.push_back({*child, X_LF * to_kdl(joint->parent_to_joint_origin_transform)});
      if (moves(*joint)) load.frozen.push_back(joint->name);
    }
  };
  hang(link, KDL::Frame::Identity());
  while (!open.empty()) {
    const Open here = open.back();
    open.pop_back();
    if (here.link->inertial) {
      load.inertia = load.inertia + here.X_LO * to_kdl(*here.link->inertial);
      load.branch_mass_kg += here.link->inertial->mass;
    }
    hang(here.link, here.X_LO);
  }
  return load;
}

KDL::Joint to_kdl_joint(const urdf::Joint& joint) {
  const KDL::Frame X_PJ = to_kdl(joint.parent_to_joint_origin_transform);
  if (!moves(joint)) return KDL::Joint(joint.name, KDL::Joint::Fixed);
  const auto type =
      joint.type == urdf::Joint::PRISMATIC ? KDL::Joint::TransAxis : KDL::Joint::RotAxis;
  KDL::Vector axis = to_kdl(joint.axis);
  axis.Normalize();
  return KDL::Joint(joint.name, X_PJ.p, X_PJ.M * axis, type);
}

JointConfig to_config(const urdf::Joint& joint, int line, Complaints* complaints,
                      std::vector<std::string>* notes) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  JointConfig config;
  config.name = joint.name;
  config.position_min = -kInfinity;
  config.position_max = kInfinity;
  const std::string where = fmt::format("joint '{}'", joint.name);
  if (joint.type == urdf::Joint::CONTINUOUS) {
    config.type = JointType::kContinuous;
  } else {
    config.type =
        joint.type == urdf::Joint::PRISMATIC ? JointType::kPrismatic : JointType::kRevolute;
    config.position_min = joint.limits->lower;
    config.position_max = joint.limits->upper;
    if (!(config.position_min < config.position_max)) {
      complaints->add(line, where,
                      fmt::format("<limit>: lower {} must be below upper {}", config.position_min,
                                  config.position_max));
    }
  }
  if (!joint.limits) {
    notes->push_back(where + ": no <limit>, so neither speed nor torque is limited by the URDF");
    config.velocity_limit = config.torque_limit_Nm = kInfinity;
    return config;
  }
  config.velocity_limit = joint.limits->velocity;
  config.torque_limit_Nm = joint.limits->effort;
  if (!(config.velocity_limit > 0.0))
    complaints->add(line, where,
                    fmt::format("<limit> velocity: {} must be above 0", config.velocity_limit));
  if (!(config.torque_limit_Nm > 0.0))
    complaints->add(line, where,
                    fmt::format("<limit> effort: {} must be above 0", config.torque_limit_Nm));
  return config;
}

urdf::LinkConstSharedPtr find_link(const urdf::ModelInterface& model, const UrdfText& text,
                                   const std::string& role, const std::string& name) {
  if (auto link = model.getLink(name)) return link;
  std::vector<std::string> links;
  for (const auto& [link, line] : text.link_lines) links.push_back(link);
  const std::string near = nearest_word(name, links);
  constexpr std::size_t kListed = 100;
  if (links.size() > kListed) links.resize(kListed);
  throw ConfigError::at(
      text.file, 0, role,
      fmt::format("no link '{}'{}; there are: {}", name,
                  near.empty() ? "" : "; did you mean '" + near + "'?", joined(links)));
}

/// Links from below the base to the tip.
std::vector<urdf::LinkConstSharedPtr> path(const urdf::LinkConstSharedPtr& base,
                                           const urdf::LinkConstSharedPtr& tip,
                                           const UrdfText& text) {
  std::vector<urdf::LinkConstSharedPtr> links;
  urdf::LinkConstSharedPtr link = tip;
  for (; link && link != base; link = link->getParent()) links.push_back(link);
  if (!link) {
    throw ConfigError::at(
        text.file, 0, "tip",
        fmt::format("link '{}' does not lie below the base '{}'", tip->name, base->name));
  }
  std::reverse(links.begin(), links.end());
  return links;
}

KDL::Rotation root_to_base(const urdf::LinkConstSharedPtr& base, std::vector<std::string>* notes) {
  KDL::Rotation R_RB = KDL::Rotation::Identity();
  for (auto link = base; link->parent_joint; link = link->getParent()) {
    const urdf::Joint& joint = *link->parent_joint;
    R_RB = to_kdl(joint.parent_to_joint_origin_transform).M * R_RB;
    if (moves(joint)) {
      notes->push_back(
          fmt::format("joint '{}' lies between root and base: frozen at zero", joint.name));
    }
  }
  return R_RB;
}

void check_count(const UrdfChain& result, const UrdfText& text, const std::string& base,
                 const std::string& tip) {
  const std::string between = fmt::format("between '{}' and '{}'", base, tip);
  if (result.joints.empty()) throw ConfigError::at(text.file, 0, "", "no moving joint " + between);
  if (result.joints.size() > kMaxJoints) {
    throw ConfigError::at(
        text.file, 0, "",
        fmt::format("{} moving joints {}; at most {}", result.joints.size(), between, kMaxJoints));
  }
}

}  // namespace

UrdfChain build_urdf_chain(const UrdfText& text, const std::string& base, const std::string& tip) {
  const urdf::ModelInterfaceSharedPtr model = parse(text);
  const auto base_link = find_link(*model, text, "base", base);
  const auto tip_link = find_link(*model, text, "tip", tip);
  const auto links = path(base_link, tip_link, text);

  UrdfChain result;
  result.notes = text.notes;
  result.R_RB = root_to_base(base_link, &result.notes);
  Complaints complaints(text.file);
  for (std::size_t i = 0; i < links.size(); ++i) {
    const urdf::Joint& joint = *links[i]->parent_joint;
    const int line = text.joint_lines.at(joint.name);
    if (joint.type == urdf::Joint::FLOATING || joint.type == urdf::Joint::PLANAR) {
      complaints.add(line, fmt::format("joint '{}'", joint.name),
                     "floating and planar joints cannot be part of an arm");
      continue;
    }
    if (moves(joint)) result.joints.push_back(to_config(joint, line, &complaints, &result.notes));
    const Load load = load_of(links[i], i + 1 < links.size() ? links[i + 1] : nullptr);
    if (load.branch_mass_kg > 0.0) {
      result.notes.push_back(fmt::format("link '{}' carries {:.4g} kg of side branches as load",
                                         links[i]->name, load.branch_mass_kg));
    }
    for (const std::string& frozen : load.frozen)
      result.notes.push_back(
          fmt::format("joint '{}' is not part of the arm: frozen at zero", frozen));
    result.chain.addSegment(KDL::Segment(links[i]->name, to_kdl_joint(joint),
                                         to_kdl(joint.parent_to_joint_origin_transform),
                                         load.inertia));
    result.segment_links.push_back(links[i]->name);
  }
  complaints.throw_if_any();
  check_count(result, text, base, tip);
  return result;
}

}  // namespace limber
