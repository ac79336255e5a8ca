#include "robots/loader/urdf_text.h"

#include <fmt/format.h>

#include <cmath>

#include "common/complaints.h"
#include "robots/loader/doubtful_figures.h"
#include "robots/loader/urdf_rules.h"

namespace limber {
namespace {

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

void check_axis(const XmlElement& joint, const std::string& where, Complaints* wrong,
                Complaints* told) {
  const XmlElement* axis = joint.child("axis");
  if (axis == nullptr) return;
  const auto xyz = attribute_numbers(*axis, "xyz");
  if (xyz.size() != 3) return;
  const double length = std::hypot(xyz[0], xyz[1], xyz[2]);
  if (!(length > 1e-6)) {
    wrong->add(axis->line, where, "<axis> xyz: the axis has no length");
  } else if (std::abs(length - 1.0) > 1e-3) {
    told->add(axis->line, where, fmt::format("axis of length {:.6g} normalised", length));
  }
}

void check_link(const XmlElement& link, const UrdfUse& use, Findings* findings) {
  const std::string name = link.attribute("name");
  const bool moves = use.moving_links.contains(name);
  const std::string where = fmt::format("link '{}'", name);
  Complaints* wrong = moves ? &findings->refused : &findings->elsewhere;
  check_urdf_numbers(link, where, [&](const std::string& tag) {
    return tag == "inertial" ? wrong : &findings->elsewhere;
  });
  const XmlElement* inertial = link.child("inertial");
  if (inertial == nullptr) return;
  std::vector<UnphysicalLink> fixed;
  check_urdf_inertial(*inertial, name,
                      {wrong, moves ? &findings->told : &findings->elsewhere,
                       moves ? "; used as it is" : "", moves ? &findings->unphysical : &fixed});
}

/// Ends of a joint that has none.
void tell_of_travel(const UrdfJointText& joint, const std::string& where, Complaints* told) {
  const XmlElement* limit = joint.element->child("limit");
  if (limit == nullptr || joint.type != "continuous") return;
  const double lower = attribute_number(*limit, "lower", 0.0);
  const double upper = attribute_number(*limit, "upper", 0.0);
  if (lower == 0.0 && upper == 0.0) return;
  told->add(limit->line, where,
            fmt::format("<limit>: lower {} and upper {} are ignored: a continuous joint turns "
                        "without end; with ends it is revolute",
                        lower, upper));
}

/// A speed that no joint reaches.
void tell_of_speed(const UrdfJointText& joint, const std::string& where, Complaints* told) {
  const XmlElement* limit = joint.element->child("limit");
  if (limit == nullptr) return;
  const double speed = attribute_number(*limit, "velocity", 0.0);
  const std::string doubt = doubtful_speed(speed, joint.type == "prismatic");
  if (!doubt.empty())
    told->add(limit->line, where, fmt::format("<limit> velocity: {}{}", speed, doubt));
}

/// Distances that no arm has.
void tell_of_lengths(const UrdfJointText& joint, const std::string& where, Complaints* told) {
  const XmlElement* origin = joint.element->child("origin");
  if (origin == nullptr) return;
  for (const double length : attribute_numbers(*origin, "xyz")) {
    const std::string doubt = doubtful_length(length);
    if (!doubt.empty())
      told->add(origin->line, where, fmt::format("<origin> xyz: {} m{}", length, doubt));
  }
}

/// A joint of the arm.
UrdfLimits check_moving(const UrdfJointText& joint, const std::string& where, bool ignores_limit,
                        Findings* findings) {
  check_urdf_numbers(*joint.element, where, [&](const std::string& tag) {
    return tag == "limit" && ignores_limit ? &findings->elsewhere : &findings->refused;
  });
  check_axis(*joint.element, where, &findings->refused, &findings->told);
  if (joint.element->child("mimic") != nullptr)
    findings->told.add(joint.line, where, "<mimic> is ignored: it moves by itself");
  tell_of_travel(joint, where, &findings->told);
  tell_of_speed(joint, where, &findings->told);
  if (ignores_limit) {
    findings->told.add(joint.line, where, "<limit> ignored (urdf_limits: ignore)");
    return {};
  }
  if (joint.type == "continuous" && joint.element->child("limit") == nullptr) {
    findings->told.add(joint.line, where,
                       "no <limit>, so neither speed nor torque is limited by the URDF");
  }
  return read_urdf_limits(joint, where, {&findings->refused, &findings->placeholders});
}

/// A joint that is frozen where it cannot be.
void tell_of_zero(const UrdfJointText& joint, const std::string& where, Complaints* told) {
  const XmlElement* limit = joint.element->child("limit");
  if (limit == nullptr || joint.type == "continuous") return;
  const double lower = attribute_number(*limit, "lower", 0.0);
  const double upper = attribute_number(*limit, "upper", 0.0);
  if (!(lower < upper) || (lower <= 0.0 && upper >= 0.0)) return;
  told->add(
      limit->line, where,
      fmt::format("frozen at zero, which lies outside its limits {} to {}: what hangs from it "
                  "is placed, and weighs, as if it were there; a fixed joint at the pose it "
                  "has would be right",
                  lower, upper));
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
  tell_of_zero(joint, where, &findings->told);
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
    const bool follows = joint->element->child("mimic") != nullptr;
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
  if (joint_use != JointUse::kNone) tell_of_lengths(joint, where, &findings->told);
  if (joint_use == JointUse::kMoves) {
    (*limits)[joint.name] = check_moving(joint, where, ignored.contains(joint.name), findings);
  } else {
    check_resting(joint, where, joint_use, use.moving_links.contains(joint.child), findings);
  }
}

/// What an element or attribute would change, if limber read it.
const std::map<std::string, std::string> kUnread = {
    {"<safety_controller>", "soft limits"},
    {"acceleration", "limber limits position, speed and torque"},
    {"deceleration", "limber limits position, speed and torque"},
    {"jerk", "limber limits position, speed and torque"},
};

/// What is in the file and nobody reads, each kind once, with the first line of it.
class Unread {
 public:
  explicit Unread(const XmlElement& root) { visit(root); }

  void tell(Complaints* told) const {
    for (const auto& [name, place] : places_) {
      const auto [line, count] = place;
      const auto why = kUnread.find(name);
      told->add(line, name,
                fmt::format("not read{}{}", count > 1 ? fmt::format(" ({} times)", count) : "",
                            why == kUnread.end() ? ": an extension" : ": " + why->second));
    }
  }

 private:
  void visit(const XmlElement& element) {
    for (const auto& [name, value] : element.attributes) {
      const bool declares = name.starts_with("xmlns:");
      const bool limit = element.name == "limit" && kUnread.contains(name);
      if ((is_foreign(name) && !declares) || limit) add(name, element.line);
    }
    for (const XmlElement& child : element.children) {
      const std::string name = fmt::format("<{}>", child.name);
      if (is_foreign(child.name) || kUnread.contains(name)) add(name, child.line);
      if (!is_foreign(child.name)) visit(child);
    }
  }

  void add(const std::string& name, int line) {
    const auto place = places_.emplace(name, std::pair{line, 0}).first;
    ++place->second.second;
  }

  std::map<std::string, std::pair<int, int>> places_;  ///< by name: first line, how often
};

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
  for (const XmlElement& element : tree.robot->children) {
    if (element.name == "link") check_link(element, use, &findings);
    if (element.name == "joint") check_joint(*joint++, use, ignored, &findings, &urdf.limits);
  }
  findings.refused.throw_if_any();
  tell_of_frozen(findings.frozen, &findings.told);
  Unread(*tree.robot).tell(&findings.told);
  urdf.placeholders = findings.placeholders.lines();
  urdf.unphysical = std::move(findings.unphysical);
  append(findings.told, "", &urdf.notes);
  append(findings.elsewhere, " (of no effect on this arm)", &urdf.notes);
  return urdf;
}

}  // namespace limber
