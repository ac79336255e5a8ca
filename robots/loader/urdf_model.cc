#include "robots/loader/urdf_model.h"

#include <urdf_model/model.h>

#include <optional>

#include "robots/loader/urdf_rules.h"

namespace limber {
namespace {

/// Zero if it is absent, nothing if it is wrong.
std::optional<urdf::Vector3> vector_of(const XmlElement& element, const char* attribute) {
  if (element.attribute(attribute) == nullptr) return urdf::Vector3(0.0, 0.0, 0.0);
  const auto numbers = attribute_numbers(element, attribute);
  if (numbers.size() != 3) return std::nullopt;
  return urdf::Vector3(numbers[0], numbers[1], numbers[2]);
}

/// The <origin> in a joint or an <inertial>; nothing if it is wrong.
std::optional<urdf::Pose> pose_in(const XmlElement& parent) {
  urdf::Pose pose;
  const XmlElement* origin = parent.child("origin");
  if (origin == nullptr) return pose;
  const auto position = vector_of(*origin, "xyz");
  const auto rpy = vector_of(*origin, "rpy");
  if (!position || !rpy) return std::nullopt;
  pose.position = *position;
  pose.rotation.setFromRPY(rpy->x, rpy->y, rpy->z);
  if (origin->attribute("quat_xyzw") == nullptr) return pose;
  const auto quaternion = attribute_numbers(*origin, "quat_xyzw");
  if (quaternion.size() != 4) return std::nullopt;
  pose.rotation.setFromQuaternion(quaternion[0], quaternion[1], quaternion[2], quaternion[3]);
  return pose;
}

urdf::InertialSharedPtr to_inertial(const XmlElement& element) {
  auto inertial = std::make_shared<urdf::Inertial>();
  inertial->origin = pose_in(element).value();
  inertial->mass = attribute_number(*element.child("mass"), "value", 0.0);
  const XmlElement& tensor = *element.child("inertia");
  inertial->ixx = attribute_number(tensor, "ixx", 0.0);
  inertial->ixy = attribute_number(tensor, "ixy", 0.0);
  inertial->ixz = attribute_number(tensor, "ixz", 0.0);
  inertial->iyy = attribute_number(tensor, "iyy", 0.0);
  inertial->iyz = attribute_number(tensor, "iyz", 0.0);
  inertial->izz = attribute_number(tensor, "izz", 0.0);
  return inertial;
}

urdf::LinkSharedPtr to_link(const std::string& name, const XmlElement& element, bool moves) {
  auto link = std::make_shared<urdf::Link>();
  link->name = name;
  const XmlElement* inertial = element.child("inertial");
  if (moves && inertial != nullptr) link->inertial = to_inertial(*inertial);
  return link;
}

urdf::JointSharedPtr to_joint(const UrdfJointText& text, const urdf::Pose& pose, bool moves) {
  auto joint = std::make_shared<urdf::Joint>();
  joint->name = text.name;
  joint->parent_link_name = text.parent;
  joint->child_link_name = text.child;
  joint->parent_to_joint_origin_transform = pose;
  joint->type = urdf::Joint::FIXED;
  if (!moves) return joint;
  joint->type = text.type == "prismatic"    ? urdf::Joint::PRISMATIC
                : text.type == "continuous" ? urdf::Joint::CONTINUOUS
                                            : urdf::Joint::REVOLUTE;
  const XmlElement* axis = text.element->child("axis");
  joint->axis = axis == nullptr ? urdf::Vector3(1.0, 0.0, 0.0) : vector_of(*axis, "xyz").value();
  return joint;
}

}  // namespace

std::shared_ptr<const urdf::ModelInterface> urdf_model(const UrdfTree& tree, const UrdfUse& use) {
  auto model = std::make_shared<urdf::ModelInterface>();
  for (const auto& [name, element] : tree.links)
    model->links_[name] = to_link(name, *element, use.moving_links.contains(name));
  for (const UrdfJointText& text : tree.joints) {
    const auto pose = pose_in(*text.element);
    if (pose) model->joints_[text.name] = to_joint(text, *pose, use.of(text) == JointUse::kMoves);
  }
  std::map<std::string, std::string> parents;
  model->initTree(parents);
  return model;
}

}  // namespace limber
