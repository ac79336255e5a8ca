#include "robots/loader/urdf_reduce.h"

#include <fmt/format.h>

#include <cmath>

#include "robots/loader/urdf_rules.h"

namespace limber {
namespace {

using tinyxml2::XMLElement;

/// Roll, pitch and yaw of a quaternion x, y, z, w of any length; exact to rounding in every pose,
/// since roll is what yaw and pitch leave.
std::string rpy_text(const std::vector<double>& quat_xyzw) {
  const double n =
      std::hypot(std::hypot(quat_xyzw[0], quat_xyzw[1]), std::hypot(quat_xyzw[2], quat_xyzw[3]));
  const double x = quat_xyzw[0] / n, y = quat_xyzw[1] / n, z = quat_xyzw[2] / n;
  const double w = quat_xyzw[3] / n;
  const double r00 = 1.0 - 2.0 * (y * y + z * z), r10 = 2.0 * (x * y + w * z);
  const double r20 = 2.0 * (x * z - w * y);
  const double r01 = 2.0 * (x * y - w * z), r11 = 1.0 - 2.0 * (x * x + z * z);
  const double r02 = 2.0 * (x * z + w * y), r12 = 2.0 * (y * z - w * x);
  const double yaw = std::atan2(r10, r00), s = std::sin(yaw), c = std::cos(yaw);
  return fmt::format("{} {} {}", std::atan2(s * r02 - c * r12, c * r11 - s * r01),
                     std::atan2(-r20, std::hypot(r00, r10)), yaw);
}

/// The library knows URDF 1.0 only.
void use_rpy(XMLElement* origin) {
  const auto quaternion = attribute_numbers(*origin, "quat_xyzw");
  if (quaternion.size() != 4) return;
  origin->SetAttribute("rpy", rpy_text(quaternion).c_str());
  origin->DeleteAttribute("quat_xyzw");
}

void copy_child(const XMLElement& from, const char* tag, XMLElement* to) {
  const XMLElement* child = from.FirstChildElement(tag);
  if (child == nullptr) return;
  XMLElement* copy = child->DeepClone(to->GetDocument())->ToElement();
  to->InsertEndChild(copy);
  XMLElement* origin = copy->FirstChildElement("origin");
  use_rpy(origin == nullptr ? copy : origin);
}

void copy_joint(const UrdfJointText& joint, bool moves, XMLElement* robot) {
  XMLElement* copy = robot->InsertNewChildElement("joint");
  copy->SetAttribute("name", joint.name.c_str());
  copy->SetAttribute("type", moves ? joint.type.c_str() : "fixed");
  copy->InsertNewChildElement("parent")->SetAttribute("link", joint.parent.c_str());
  copy->InsertNewChildElement("child")->SetAttribute("link", joint.child.c_str());
  copy_child(*joint.element, "origin", copy);
  if (!moves) return;
  copy_child(*joint.element, "axis", copy);
  XMLElement* limit = copy->InsertNewChildElement("limit");  // the library insists on one
  for (const char* attribute : {"effort", "velocity"}) limit->SetAttribute(attribute, 0);
}

}  // namespace

std::string reduced_urdf(const UrdfTree& tree, const UrdfUse& use) {
  tinyxml2::XMLDocument document;
  XMLElement* robot = document.NewElement("robot");
  robot->SetAttribute("name", tree.document->RootElement()->Attribute("name"));
  document.InsertEndChild(robot);
  for (const std::string& link : use.placed_links) {
    XMLElement* copy = robot->InsertNewChildElement("link");
    copy->SetAttribute("name", link.c_str());
    if (use.moving_links.contains(link)) copy_child(*tree.links.at(link), "inertial", copy);
  }
  for (const UrdfJointText& joint : tree.joints) {
    const JointUse joint_use = use.of(joint);
    if (joint_use != JointUse::kNone) copy_joint(joint, joint_use == JointUse::kMoves, robot);
  }
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

}  // namespace limber
