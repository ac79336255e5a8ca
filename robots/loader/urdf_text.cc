#include "robots/loader/urdf_text.h"

#include <fmt/format.h>

#include <cmath>

#include "common/complaints.h"
#include "robots/loader/urdf_reduce.h"
#include "robots/loader/urdf_rules.h"

namespace limber {
namespace {

using tinyxml2::XMLElement;

/// Where a finding goes.
struct Findings {
  explicit Findings(const std::string& file)
      : refused(file), elsewhere(file), told(file), placeholders(file) {}

  Complaints refused;
  Complaints elsewhere;  ///< wrong, but of no effect on this chain
  Complaints told;       ///< worth knowing
  Complaints placeholders;
  std::vector<UnphysicalLink> unphysical;
  std::vector<const UrdfJointText*> frozen;  ///< joints that the arm carries
};

void check_axis(const XMLElement& joint, const std::string& where, Complaints* wrong,
                Complaints* told) {
  const XMLElement* axis = joint.FirstChildElement("axis");
  if (axis == nullptr) return;
  const auto xyz = attribute_numbers(*axis, "xyz");
  if (xyz.size() != 3) return;
  const double length = std::hypot(xyz[0], xyz[1], xyz[2]);
  if (!(length > 1e-6)) {
    wrong->add(axis->GetLineNum(), where, "<axis> xyz: the axis has no length");
  } else if (std::abs(length - 1.0) > 1e-3) {
    told->add(axis->GetLineNum(), where, fmt::format("axis of length {:.6g} normalised", length));
  }
}

void check_link(const XMLElement& link, const UrdfUse& use, Findings* findings) {
  const std::string name = link.Attribute("name");
  const bool moves = use.moving_links.contains(name);
  const std::string where = fmt::format("link '{}'", name);
  Complaints* wrong = moves ? &findings->refused : &findings->elsewhere;
  check_urdf_numbers(link, where, [&](const std::string& tag) {
    return tag == "inertial" ? wrong : &findings->elsewhere;
  });
  const XMLElement* inertial = link.FirstChildElement("inertial");
  if (inertial == nullptr) return;
  std::vector<UnphysicalLink> fixed;
  check_urdf_inertial(*inertial, name,
                      {wrong, moves ? &findings->told : &findings->elsewhere,
                       moves ? "; used as it is" : "", moves ? &findings->unphysical : &fixed});
}

/// A joint of the arm.
UrdfLimits check_moving(const UrdfJointText& joint, const std::string& where, bool ignores_limit,
                        Findings* findings) {
  check_urdf_numbers(*joint.element, where, [&](const std::string& tag) {
    return tag == "limit" && ignores_limit ? &findings->elsewhere : &findings->refused;
  });
  check_axis(*joint.element, where, &findings->refused, &findings->told);
  if (joint.element->FirstChildElement("mimic") != nullptr)
    findings->told.add(joint.line, where, "<mimic> is ignored: it moves by itself");
  if (ignores_limit) {
    findings->told.add(joint.line, where, "<limit> ignored (urdf_limits: ignore)");
    return {};
  }
  if (joint.type == "continuous" && joint.element->FirstChildElement("limit") == nullptr) {
    findings->told.add(joint.line, where,
                       "no <limit>, so neither speed nor torque is limited by the URDF");
  }
  return read_urdf_limits(joint, where, {&findings->refused, &findings->placeholders});
}

/// A joint that keeps its place, or is not used at all. `carried`: by a link of the arm.
void check_resting(const UrdfJointText& joint, const std::string& where, JointUse use, bool carried,
                   Findings* findings) {
  check_urdf_numbers(*joint.element, where, [&](const std::string& tag) {
    return tag == "origin" && use == JointUse::kPlaces ? &findings->refused : &findings->elsewhere;
  });
  check_axis(*joint.element, where, &findings->elsewhere, &findings->elsewhere);
  if (const std::string problem = joint.type_problem(); !problem.empty())
    findings->elsewhere.add(joint.line, where, problem);
  if (use == JointUse::kNone || !joint.moves()) return;
  if (carried) {
    findings->frozen.push_back(&joint);
  } else {
    findings->told.add(joint.line, where, "between root and base: frozen at zero");
  }
}

/// A hand has many joints: one note for all.
void tell_of_frozen(const std::vector<const UrdfJointText*>& frozen, Complaints* told) {
  if (frozen.empty()) return;
  std::string names;
  for (const UrdfJointText* joint : frozen) {
    const bool follows = joint->element->FirstChildElement("mimic") != nullptr;
    names += fmt::format("{}'{}' (line {}{})", names.empty() ? "" : ", ", joint->name, joint->line,
                         follows ? ", its <mimic> is ignored" : "");
  }
  told->add(frozen.front()->line, frozen.size() == 1 ? "joint" : "joints",
            "not part of the arm, frozen at zero: " + names);
}

void check_joint(const UrdfJointText& joint, const UrdfUse& use,
                 const std::set<std::string>& ignored, Findings* findings,
                 std::map<std::string, UrdfLimits>* limits) {
  const std::string where = fmt::format("joint '{}'", joint.name);
  const JointUse joint_use = use.of(joint);
  if (joint_use == JointUse::kMoves) {
    (*limits)[joint.name] = check_moving(joint, where, ignored.contains(joint.name), findings);
  } else {
    check_resting(joint, where, joint_use, use.moving_links.contains(joint.child), findings);
  }
}

void append(const Complaints& complaints, const std::string& ending,
            std::vector<std::string>* notes) {
  for (const std::string& line : complaints.lines()) notes->push_back(line + ending);
}

}  // namespace

UrdfText check_urdf(const UrdfTree& tree, const UrdfUse& use,
                    const std::set<std::string>& ignored) {
  UrdfText urdf;
  Findings findings(tree.file);
  auto joint = tree.joints.begin();  // both in file order
  for (auto* element = tree.document->RootElement()->FirstChildElement(); element != nullptr;
       element = element->NextSiblingElement()) {
    const std::string tag = element->Name();
    if (tag == "link") check_link(*element, use, &findings);
    if (tag == "joint") check_joint(*joint++, use, ignored, &findings, &urdf.limits);
  }
  findings.refused.throw_if_any();
  tell_of_frozen(findings.frozen, &findings.told);
  urdf.placeholders = findings.placeholders.lines();
  urdf.unphysical = std::move(findings.unphysical);
  append(findings.told, "", &urdf.notes);
  append(findings.elsewhere, " (of no effect on this arm)", &urdf.notes);
  urdf.text = reduced_urdf(tree, use);
  return urdf;
}

}  // namespace limber
