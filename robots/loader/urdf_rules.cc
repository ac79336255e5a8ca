#include "robots/loader/urdf_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <sstream>

#include "common/parse_number.h"
#include "common/suggest.h"

namespace limber {
namespace {

/// No joint limit or mounting angle is two turns; 90 or 180 is.
constexpr double kLargestAngle_rad = 4.0 * std::numbers::pi;

/// Of a quaternion's length: what is written with three digits is one.
constexpr double kRoundedQuaternion = 5e-3;

struct NumberRule {
  const char* element;
  const char* attribute;
  std::size_t count;
  bool required;
};

constexpr NumberRule kNumberRules[] = {
    {"origin", "xyz", 3, false},
    {"origin", "rpy", 3, false},
    {"origin", "quat_xyzw", 4, false},
    {"mass", "value", 1, true},
    {"inertia", "ixx", 1, true},
    {"inertia", "ixy", 1, true},
    {"inertia", "ixz", 1, true},
    {"inertia", "iyy", 1, true},
    {"inertia", "iyz", 1, true},
    {"inertia", "izz", 1, true},
    {"axis", "xyz", 3, true},
    {"limit", "lower", 1, false},
    {"limit", "upper", 1, false},
    {"limit", "effort", 1, false},
    {"limit", "velocity", 1, false},
    {"limit", "acceleration", 1, false},
    {"limit", "deceleration", 1, false},
    {"limit", "jerk", 1, false},
    {"dynamics", "damping", 1, false},
    {"dynamics", "friction", 1, false},
    {"mimic", "multiplier", 1, false},
    {"mimic", "offset", 1, false},
    {"safety_controller", "soft_lower_limit", 1, false},
    {"safety_controller", "soft_upper_limit", 1, false},
    {"safety_controller", "k_position", 1, false},
    {"safety_controller", "k_velocity", 1, false},
    {"calibration", "rising", 1, false},
    {"calibration", "falling", 1, false},
    {"box", "size", 3, true},
    {"cylinder", "radius", 1, true},
    {"cylinder", "length", 1, true},
    {"sphere", "radius", 1, true},
    {"capsule", "radius", 1, true},
    {"capsule", "length", 1, true},
    {"mesh", "scale", 3, false},
    {"color", "rgba", 4, true},
};

/// Elements whose attributes are all in the table: another name there is a slip that would be
/// ignored.
constexpr const char* kClosedElements[] = {"origin", "mass", "inertia", "axis", "limit"};
/// Simulators keep figures of their own here, as "mu_viscous"; what is close to ours is a slip.
constexpr const char* kSharedElement = "dynamics";
/// Elements that may stand only once in their parent: the first counts.
constexpr const char* kSingleElements[] = {"origin", "mass",  "inertia",  "axis",  "limit",
                                           "parent", "child", "inertial", "mimic", "dynamics"};
/// What may stand below <link> and <joint>; something close to one of these is a slip.
const std::vector<std::string> kLinkChildren = {"inertial", "visual", "collision"};
const std::vector<std::string> kJointChildren = {
    "origin",     "parent", "child", "axis", "limit", "mimic", "dynamics", "safety_controller",
    "calibration"};
const std::vector<std::string> kInertialChildren = {"origin", "mass", "inertia"};

template <std::size_t n>
bool is_one_of(const std::string& name, const char* const (&names)[n]) {
  return std::any_of(std::begin(names), std::end(names),
                     [&](const char* other) { return name == other; });
}

std::string quote(const char* text) {
  constexpr std::size_t kLongest = 40;
  const std::string_view all(text);
  return fmt::format("\"{}{}\"", all.substr(0, kLongest), all.size() > kLongest ? "..." : "");
}

void check_angle(const XmlElement& element, const char* attribute, const std::string& where,
                 Complaints* complaints) {
  for (const double angle : attribute_numbers(element, attribute)) {
    if (std::abs(angle) <= kLargestAngle_rad) continue;
    complaints->add(element.line, where,
                    fmt::format("<{}> {}: {} rad is more than two turns; are these degrees?",
                                element.name, attribute, angle));
  }
}

void check_quaternion(const XmlElement& element, const std::string& where, Complaints* complaints) {
  const auto q = attribute_numbers(element, "quat_xyzw");
  if (q.size() != 4) return;
  const std::string place = fmt::format("<{}> quat_xyzw: ", element.name);
  if (element.attribute("rpy") != nullptr)
    complaints->add(element.line, where, place + "rpy is here, too; leave one of them out");
  const double norm = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  if (std::abs(norm - 1.0) <= kRoundedQuaternion) return;
  complaints->add(
      element.line, where,
      place + fmt::format("a quaternion of length {:.6g} is no rotation; expected 1", norm));
}

void check_number(const XmlElement& element, const NumberRule& rule, const std::string& where,
                  Complaints* complaints) {
  const char* text = element.attribute(rule.attribute);
  const std::string place = fmt::format("<{}> {}", element.name, rule.attribute);
  if (text == nullptr) {
    if (rule.required) complaints->add(element.line, where, place + " is missing");
    return;
  }
  if (attribute_numbers(element, rule.attribute).size() == rule.count) return;
  const std::string what =
      rule.count == 1 ? "a finite number" : fmt::format("{} finite numbers", rule.count);
  complaints->add(element.line, where, fmt::format("{}: {} is not {}", place, quote(text), what));
}

void check_attribute_names(const XmlElement& element, const std::string& where,
                           Complaints* complaints) {
  const bool shared = element.name == kSharedElement;
  if (!shared && !is_one_of(element.name, kClosedElements)) return;
  std::vector<std::string> allowed;
  for (const NumberRule& rule : kNumberRules) {
    if (element.name == rule.element) allowed.push_back(rule.attribute);
  }
  for (const auto& [name, value] : element.attributes) {
    if (std::find(allowed.begin(), allowed.end(), name) != allowed.end()) continue;
    if (is_foreign(name)) continue;
    if (shared && nearest_word(name, allowed).empty()) continue;
    complaints->add(element.line, where,
                    fmt::format("<{}>: unknown attribute '{}'; allowed here: {}", element.name,
                                name, joined(allowed)));
  }
}

void check_children(const XmlElement& element, const std::string& where,
                    const ComplaintsOf& complaints_of) {
  const std::string name = element.name;
  const std::vector<std::string>* known = name == "link"       ? &kLinkChildren
                                          : name == "joint"    ? &kJointChildren
                                          : name == "inertial" ? &kInertialChildren
                                                               : nullptr;
  for (const XmlElement& child : element.children) {
    const std::string& tag = child.name;
    if (is_foreign(tag)) continue;
    if (is_one_of(tag, kSingleElements) && element.child(tag) != &child) {
      complaints_of(tag)->add(child.line, where, fmt::format("<{}> is here twice", tag));
    }
    if (known == nullptr || std::find(known->begin(), known->end(), tag) != known->end()) continue;
    const std::string near = nearest_word(tag, *known);
    if (near.empty()) continue;
    complaints_of(near)->add(child.line, where,
                             fmt::format("<{}>: unknown element; did you mean <{}>?", tag, near));
  }
}

void check_element(const XmlElement& element, const std::string& where, Complaints* complaints) {
  for (const NumberRule& rule : kNumberRules) {
    if (element.name == rule.element) check_number(element, rule, where, complaints);
  }
  check_angle(element, "rpy", where, complaints);
  check_quaternion(element, where, complaints);
  check_attribute_names(element, where, complaints);
  check_children(element, where, [&](const std::string&) { return complaints; });
  // The parser refuses nesting deeper than 100, so this recursion is bounded.
  for (const XmlElement& child : element.children) {
    if (!is_foreign(child.name)) check_element(child, where, complaints);
  }
}

}  // namespace

bool is_foreign(std::string_view name) { return name.find(':') != std::string_view::npos; }

std::vector<double> attribute_numbers(const XmlElement& element, const char* attribute) {
  const char* text = element.attribute(attribute);
  std::istringstream words(text == nullptr ? "" : text);
  std::vector<double> numbers;
  for (std::string word; words >> word;) {
    const auto number = parse_number(word);
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

double attribute_number(const XmlElement& element, const char* attribute, double otherwise) {
  const auto numbers = attribute_numbers(element, attribute);
  return numbers.empty() ? otherwise : numbers.front();
}

void check_urdf_numbers(const XmlElement& top, const std::string& where,
                        const ComplaintsOf& complaints_of) {
  check_children(top, where, complaints_of);
  for (const XmlElement& child : top.children) {
    if (!is_foreign(child.name)) check_element(child, where, complaints_of(child.name));
  }
}

}  // namespace limber
