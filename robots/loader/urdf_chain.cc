#include "robots/loader/urdf_chain.h"

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
#include "robots/loader/urdf_to_kdl.h"

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

JointConfig to_config(const urdf::Joint& joint, int line, Complaints* complaints,
                      std::vector<std::string>* notes) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::string where = fmt::format("joint '{}'", joint.name);
  JointConfig config;
  config.name = joint.name;
  config.position_min = -kInfinity;
  config.position_max = kInfinity;
  config.type = JointType::kContinuous;
  if (joint.type != urdf::Joint::CONTINUOUS) {
    config.type =
        joint.type == urdf::Joint::PRISMATIC ? JointType::kPrismatic : JointType::kRevolute;
    config.position_min = joint.limits->lower;
    config.position_max = joint.limits->upper;
  }
  config.velocity_limit = joint.limits ? joint.limits->velocity : kInfinity;
  config.torque_limit_Nm = joint.limits ? joint.limits->effort : kInfinity;
  if (!joint.limits)
    notes->push_back(where + ": no <limit>, so neither speed nor torque is limited by the URDF");
  const auto expect = [&](bool right, const std::string& problem) {
    if (!right) complaints->add(line, where, "<limit>" + problem);
  };
  expect(
      config.position_min < config.position_max,
      fmt::format(": lower {} must be below upper {}", config.position_min, config.position_max));
  expect(config.velocity_limit > 0.0,
         fmt::format(" velocity: {} must be above 0", config.velocity_limit));
  expect(config.torque_limit_Nm > 0.0,
         fmt::format(" effort: {} must be above 0", config.torque_limit_Nm));
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

/// The joint above a link, and the link with its load.
void add_segment(const urdf::Link& link, const urdf::Link* next, const UrdfText& text,
                 Complaints* complaints, UrdfChain* result) {
  const urdf::Joint& joint = *link.parent_joint;
  const int line = text.joint_lines.at(joint.name);
  if (joint.type == urdf::Joint::FLOATING || joint.type == urdf::Joint::PLANAR) {
    complaints->add(line, fmt::format("joint '{}'", joint.name),
                    "floating and planar joints cannot be part of an arm");
    return;
  }
  if (moves(joint)) result->joints.push_back(to_config(joint, line, complaints, &result->notes));
  const Load load = load_of(link, next);
  if (load.branch_mass_kg > 0.0) {
    result->notes.push_back(fmt::format("link '{}' carries {:.4g} kg of side branches as load",
                                        link.name, load.branch_mass_kg));
  }
  for (const std::string& frozen : load.frozen) {
    result->notes.push_back(
        fmt::format("joint '{}' is not part of the arm: frozen at zero", frozen));
  }
  result->chain.addSegment(KDL::Segment(
      link.name, to_kdl(joint), to_kdl(joint.parent_to_joint_origin_transform), load.inertia));
  result->segment_links.push_back(link.name);
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
  const auto links = path(base_link, find_link(*model, text, "tip", tip), text);
  UrdfChain result;
  result.notes = text.notes;
  result.R_RB = root_to_base(base_link, &result.notes);
  Complaints complaints(text.file);
  for (std::size_t i = 0; i < links.size(); ++i)
    add_segment(*links[i], i + 1 < links.size() ? links[i + 1].get() : nullptr, text, &complaints,
                &result);
  complaints.throw_if_any();
  check_count(result, text, base, tip);
  return result;
}

}  // namespace limber
