#include "robots/joint_yaml.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/complaints.h"
#include "robots/address_yaml.h"

namespace limber {
namespace {

/// Endings of the keys of one joint.
struct Units {
  std::string position, velocity, force, force_rate, stiffness, damping;
};
const Units kRotary = {"_rad", "_rad_per_s", "_Nm", "_Nm_per_s", "_Nm_per_rad", "_Nms_per_rad"};
const Units kLinear = {"_m", "_m_per_s", "_N", "_N_per_s", "_N_per_m", "_Ns_per_m"};

const Units& units_of(const JointConfig& joint) {
  return joint.type == JointType::kPrismatic ? kLinear : kRotary;
}

/// A limit that robot.yaml may only tighten.
void tighten(const YamlMap& yaml, const std::string& key, double* limit) {
  if (!yaml.has(key)) return;
  const double wanted = yaml.number(key, {1e-6, 1e6});
  if (!(wanted <= *limit))
    yaml.refuse(key, fmt::format("{} is wider than the {} of URDF and motor", wanted, *limit));
  *limit = wanted;
}

void read_limits(const YamlMap& yaml, JointConfig* joint) {
  const Units& units = units_of(*joint);
  const std::string low = "position_min" + units.position;
  const std::string high = "position_max" + units.position;
  if (yaml.has(low)) {
    const double wanted = yaml.number(low, {-1e3, 1e3});
    if (!(wanted >= joint->position_min))
      yaml.refuse(low, fmt::format("{} is below the {} of the URDF", wanted, joint->position_min));
    joint->position_min = wanted;
  }
  if (yaml.has(high)) {
    const double wanted = yaml.number(high, {-1e3, 1e3});
    if (!(wanted <= joint->position_max))
      yaml.refuse(high, fmt::format("{} is above the {} of the URDF", wanted, joint->position_max));
    joint->position_max = wanted;
  }
  if (!(joint->position_min < joint->position_max)) {
    yaml.refuse(yaml.has(high) ? high : low,
                fmt::format("no room between {} and {}", joint->position_min, joint->position_max));
  }
  const DriveConfig& drive = joint->drive;
  joint->velocity_limit = std::min(joint->velocity_limit, drive.range.velocity_rad_per_s);
  joint->torque_limit_Nm =
      std::min({joint->torque_limit_Nm, drive.peak_torque_Nm, drive.range.torque_Nm});
  tighten(yaml, "velocity_limit" + units.velocity, &joint->velocity_limit);
  tighten(yaml, "torque_limit" + units.force, &joint->torque_limit_Nm);
  // From zero to the limit in 20 ms, but never faster than 1 N m in a millisecond unless asked for.
  const double gentle = std::min(joint->torque_limit_Nm / 0.02, 1000.0);
  joint->torque_rate_limit_Nm_per_s =
      yaml.number_or("torque_rate_limit" + units.force_rate, {1e-3, 1e6}, gentle);
}

/// The drive reports positions within +-range only: the whole way of the joint must lie inside.
void check_drive_range(const YamlMap& yaml, const JointConfig& joint) {
  const DriveConfig& drive = joint.drive;
  const double ends[] = {drive.sign * joint.position_min + drive.offset_rad,
                         drive.sign * joint.position_max + drive.offset_rad};
  for (const double angle : ends) {
    if (std::abs(angle) <= drive.range.position_rad) continue;
    yaml.refuse(fmt::format(
        "the joint's way from {} to {} needs drive angles from {} to {}, but the drive's position "
        "range is +-{}; tighten the position limits or change the offset",
        joint.position_min, joint.position_max, std::min(ends[0], ends[1]),
        std::max(ends[0], ends[1]), drive.range.position_rad));
  }
}

FrictionConfig read_friction(const YamlMap& yaml, const Units& units) {
  FrictionConfig friction;
  friction.coulomb_Nm = yaml.number("coulomb" + units.force, {0.0, 1000.0});
  friction.static_Nm = yaml.number_or("static" + units.force, {0.0, 1000.0}, friction.coulomb_Nm);
  if (!(friction.static_Nm >= friction.coulomb_Nm))
    yaml.refuse("static" + units.force, "must be at least the coulomb friction");
  friction.viscous_Nms_per_rad = yaml.number("viscous" + units.damping, {0.0, 1000.0});
  friction.stribeck_rad_per_s =
      yaml.number_or("stribeck" + units.velocity, {1e-6, 100.0}, friction.stribeck_rad_per_s);
  friction.bristle_rad =
      yaml.number_or("bristle" + units.position, {1e-7, 0.1}, friction.bristle_rad);
  yaml.finish();
  return friction;
}

void read_hold(const YamlMap& yaml, const Units& units, DriveConfig* drive) {
  drive->hold_kp_Nm_per_rad =
      yaml.number("kp" + units.stiffness, {0.0, drive->range.kp_Nm_per_rad});
  drive->hold_kd_Nms_per_rad =
      yaml.number("kd" + units.damping, {0.0, drive->range.kd_Nms_per_rad});
  yaml.finish();
}

void read_joint(const YamlMap& yaml, const std::map<std::string, DriveConfig>& motors,
                std::size_t index, Robot* robot) {
  JointConfig& joint = robot->joints[index];
  const Units& units = units_of(joint);
  std::vector<std::string> types;
  types.reserve(motors.size());
  for (const auto& [name, motor] : motors) types.push_back(name);
  joint.drive = motors.at(yaml.word("motor", types));
  read_address(yaml, *robot, index, &joint);
  joint.drive.sign = yaml.integer_or("sign", -1, 1, 1) == -1 ? -1.0 : 1.0;
  if (yaml.integer_or("sign", -1, 1, 1) == 0) yaml.refuse("sign", "found '0'; expected 1 or -1");
  joint.drive.offset_rad = yaml.number_or("offset" + units.position, {-1e3, 1e3}, 0.0);
  read_limits(yaml, &joint);
  check_drive_range(yaml, joint);
  joint.home = yaml.number("home" + units.position, {-1e3, 1e3});
  if (!(joint.home >= joint.position_min && joint.home <= joint.position_max)) {
    yaml.refuse("home" + units.position,
                fmt::format("{} is outside the limits {} to {}", joint.home, joint.position_min,
                            joint.position_max));
  }
  if (yaml.has("friction")) joint.friction = read_friction(yaml.map("friction"), units);
  read_hold(yaml.map("hold"), units, &joint.drive);
  yaml.finish();
}

}  // namespace

void read_joints(const YamlMap& yaml, const std::map<std::string, DriveConfig>& motors,
                 Robot* robot) {
  const YamlMap section = yaml.map("joints");
  Complaints complaints(yaml.file());
  for (std::size_t i = 0; i < robot->joints.size(); ++i) {
    complaints.collect([&] { read_joint(section.map(robot->joints[i].name), motors, i, robot); });
  }
  complaints.collect([&] { section.finish(); });
  complaints.throw_if_any();
}

}  // namespace limber
