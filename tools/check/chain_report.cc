#include "tools/check/chain_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/check/json.h"

namespace limber {
namespace {

const char* kind_name(TransmissionKind kind) {
  switch (kind) {
    case TransmissionKind::kRigid:
      return "rigid";
    case TransmissionKind::kElastic:
      return "elastic";
    case TransmissionKind::kAntagonistic:
      return "antagonistic";
  }
  return "";
}

const char* law_name(SpringLaw law) {
  switch (law) {
    case SpringLaw::kLinear:
      return "linear";
    case SpringLaw::kQuadratic:
      return "quadratic";
    case SpringLaw::kCubic:
      return "cubic";
    case SpringLaw::kExponential:
      return "exponential";
    case SpringLaw::kSinh:
      return "sinh";
  }
  return "";
}

std::string friction_json(const FrictionConfig& friction) {
  return json::object({{"coulomb_Nm", json::number(friction.coulomb_Nm)},
                       {"static_Nm", json::number(friction.static_Nm)},
                       {"viscous_Nms_per_rad", json::number(friction.viscous_Nms_per_rad)}});
}

std::string spring_text(const SpringConfig& spring) {
  switch (spring.law) {
    case SpringLaw::kLinear:
      return fmt::format("{:g} d", spring.stiffness_Nm_per_rad);
    case SpringLaw::kQuadratic:
      return fmt::format("{:g} d^2/2", spring.k2_Nm_per_rad2);
    case SpringLaw::kCubic:
      return fmt::format("{:g} d + {:g} d^3", spring.stiffness_Nm_per_rad, spring.k3_Nm_per_rad3);
    case SpringLaw::kExponential:
      return fmt::format("{:g} (exp({:g} d) - 1)", spring.force_Nm, spring.rate_per_rad);
    case SpringLaw::kSinh:
      return fmt::format("{:g} sinh({:g} d)", spring.force_Nm, spring.rate_per_rad);
  }
  return "";
}

std::string loop_text(const JointConfig& joint) {
  if (!joint.torque_loop.present()) return "-";
  return fmt::format("B/{:g} at {:g} Hz, {:.3g} s", joint.torque_loop.inertia_ratio,
                     joint.torque_loop.rate_hz, joint.torque_loop.delay_s);
}

std::string sensors_text(const JointConfig& joint) {
  std::string text = fmt::format("motor {:.3g} bit", std::log2(joint.drive.counts_per_turn));
  if (joint.link_encoder.present) text += fmt::format(", link {} bit", joint.link_encoder.bits);
  if (joint.torque_sensor.present) text += ", torque";
  return text;
}

std::string row(const JointConfig& joint) {
  std::string motors = fmt::format("{:.3g}", joint.drive.rotor_inertia_kgm2);
  if (joint.has_antagonist) motors += fmt::format(" + {:.3g}", joint.antagonist.rotor_inertia_kgm2);
  return fmt::format("  {:<14} {:<12} {:>11} {:<18} {:>8.3g}  {:<24} {}\n", joint.name,
                     kind_name(joint.transmission.kind), motors,
                     joint.rigid() ? "-" : spring_text(joint.transmission.spring),
                     joint.transmission.damping_Nms_per_rad, loop_text(joint), sensors_text(joint));
}

}  // namespace

double largest_inertia_ratio(const JointConfig& joint) {
  const TorqueLoopConfig& loop = joint.torque_loop;
  const double late_s = 0.5 / loop.rate_hz + loop.delay_s + joint.torque_sensor.delay_s +
                        joint.torque_sensor.filter_s;
  const double D_J = joint.transmission.damping_Nms_per_rad;
  const double taken = joint.transmission.spring.stiffness_Nm_per_rad * late_s - D_J;
  if (!(taken > 0.0)) return std::numeric_limits<double>::infinity();
  return 1.0 + (joint.friction.viscous_Nms_per_rad + D_J) / taken;
}

std::string chain_table(const Robot& robot) {
  const bool rigid = std::all_of(robot.joints.begin(), robot.joints.end(),
                                 [](const JointConfig& joint) { return joint.rigid(); });
  if (rigid) return "";
  std::string table =
      fmt::format("  {:<14} {:<12} {:>11} {:<18} {:>8}  {:<24} {}\n", "joint", "transmission", "B",
                  "spring", "damper", "torque loop", "sensors");
  for (const JointConfig& joint : robot.joints) table += row(joint);
  return table;
}

json::Members chain_members(const JointConfig& joint) {
  const SpringConfig& spring = joint.transmission.spring;
  return {{"transmission", json::text(kind_name(joint.transmission.kind))},
          {"motors", json::number(joint.motors())},
          {"spring_law", json::text(law_name(spring.law))},
          {"spring_stiffness_Nm_per_rad", json::number(spring.stiffness_Nm_per_rad)},
          {"spring_k2_Nm_per_rad2", json::number(spring.k2_Nm_per_rad2)},
          {"preload_max_rad", json::number(joint.transmission.preload_max_rad)},
          {"joint_damping_Nms_per_rad", json::number(joint.transmission.damping_Nms_per_rad)},
          {"friction", friction_json(joint.friction)},
          {"link_friction", friction_json(joint.link_friction)},
          {"link_encoder", json::flag(joint.link_encoder.present)},
          {"torque_sensor", json::flag(joint.torque_sensor.present)},
          {"torque_loop_inertia_ratio", json::number(joint.torque_loop.inertia_ratio)}};
}

std::vector<std::string> chain_warnings(const Robot& robot) {
  std::vector<std::string> warnings;
  for (const JointConfig& joint : robot.joints) {
    if (!joint.torque_loop.present()) continue;
    const double most = largest_inertia_ratio(joint);
    if (joint.torque_loop.inertia_ratio < most) continue;
    warnings.push_back(fmt::format(
        "{}: a torque loop with inertia_ratio {:g} is expected to be unstable; below {:.3g} it is "
        "not, or faster, or with more damping at the motor",
        joint.name, joint.torque_loop.inertia_ratio, most));
  }
  return warnings;
}

}  // namespace limber
