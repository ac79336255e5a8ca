#include "robots/loader/urdf_reduce.h"

namespace limber {
namespace {

using tinyxml2::XMLElement;

void copy_child(const XMLElement& from, const char* tag, XMLElement* to) {
  if (const XMLElement* child = from.FirstChildElement(tag))
    to->InsertEndChild(child->DeepClone(to->GetDocument()));
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
  XMLElement* robot = tree.document->RootElement()->ShallowClone(&document)->ToElement();
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
