#include "robots/loader/urdf_limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robots/loader/urdf_rules.h"

namespace limber {
namespace {

constexpr double kLargestTravel_rad = 4.0 * std::numbers::pi;

void read_travel(const XmlElement& limit, const std::string& type, const std::string& where,
                 const LimitFindings& findings, UrdfLimits* limits) {
  const double lower = attribute_number(limit, "lower", 0.0);
  const double upper = attribute_number(limit, "upper", 0.0);
  const int line = limit.line;
  if (lower == 0.0 && upper == 0.0) {
    findings.placeholders->add(line, where, "<limit>: lower and upper are 0 (or absent)");
    return;
  }
  if (!(lower < upper)) {
    findings.refused->add(line, where,
                          fmt::format("<limit>: lower {} must be below upper {}", lower, upper));
  }
  if (type == "revolute" && std::max(std::abs(lower), std::abs(upper)) > kLargestTravel_rad) {
    findings.refused->add(line, where,
                          fmt::format("<limit>: {} to {} rad is more than two turns; are these "
                                      "degrees?",
                                      lower, upper));
  }
  limits->lower = lower;
  limits->upper = upper;
}

void read_most(const XmlElement& limit, const char* attribute, const std::string& where,
               const LimitFindings& findings, double* most) {
  if (limit.attribute(attribute) == nullptr) {
    findings.placeholders->add(limit.line, where, fmt::format("<limit> without {}", attribute));
    return;
  }
  const auto value = attribute_numbers(limit, attribute);
  if (value.empty()) return;
  if (value[0] == 0.0) {
    findings.placeholders->add(limit.line, where, fmt::format("<limit> {}: 0", attribute));
  } else if (!(value[0] > 0.0)) {
    findings.refused->add(limit.line, where,
                          fmt::format("<limit> {}: {} must be above 0", attribute, value[0]));
  } else {
    *most = value[0];
  }
}

}  // namespace

UrdfLimits read_urdf_limits(const UrdfJointText& joint, const std::string& where,
                            const LimitFindings& findings) {
  UrdfLimits limits;
  const XmlElement* limit = joint.element->child("limit");
  if (limit == nullptr) {
    if (joint.type != "continuous")
      findings.placeholders->add(joint.line, where, "no <limit lower upper effort velocity>");
    return limits;
  }
  if (joint.type != "continuous") read_travel(*limit, joint.type, where, findings, &limits);
  read_most(*limit, "velocity", where, findings, &limits.velocity);
  read_most(*limit, "effort", where, findings, &limits.effort);
  return limits;
}

}  // namespace limber
