#include "robots/loader/joint_yaml.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/complaints.h"
#include "common/joints.h"
#include "common/suggest.h"
#include "common/unit_hint.h"
#include "robots/loader/address_yaml.h"
#include "robots/loader/joint_chain_yaml.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "robots/loader/second_motor.h"

namespace limber {
namespace {

/// A limit that robot.yaml may only tighten.
void tighten(const YamlMap& yaml, const std::string& key, double* limit) {
  if (!yaml.has(key)) return;
  const double wanted = yaml.number(key, {1e-6, 1e6});
  if (!(wanted <= *limit))
    yaml.refuse(key, fmt::format("{} is wider than the {} of URDF and motor{}", wanted, *limit,
                                 unit_hint(key, wanted, 0.0, *limit)));
  *limit = wanted;
}

/// Without the URDF's limits each has to be here.
void need_limits(const YamlMap& yaml, const JointUnits& units, bool has_ends) {
  std::vector<std::string> keys = {"velocity_limit" + units.velocity, "torque_limit" + units.force};
  if (has_ends) {
    for (const char* end : {"position_min", "position_max"}) keys.push_back(end + units.position);
  }
  std::erase_if(keys, [&](const std::string& key) { return yaml.has(key); });
  if (!keys.empty())
    yaml.refuse("urdf_limits",
                "ignore: then robot.yaml gives every limit; missing: " + joined(keys));
}

/// As in a URDF: no joint turns further than twice.
void refuse_degrees(const YamlMap& yaml, const JointConfig& joint, const std::string& low,
                    const std::string& high) {
  constexpr double kFurthest_rad = 4.0 * std::numbers::pi;
  if (joint.type != JointType::kRevolute) return;
  for (const auto& [key, value] :
       {std::pair{low, joint.position_min}, std::pair{high, joint.position_max}}) {
    if (!yaml.has(key) || std::abs(value) <= kFurthest_rad) continue;
    yaml.refuse(key, fmt::format("{} rad is more than two turns{}", value,
                                 unit_hint(key, value, -kFurthest_rad, kFurthest_rad)));
  }
}

void read_limits(const YamlMap& yaml, JointConfig* joint) {
  const JointUnits& units = units_of(*joint);
  const std::string low = "position_min" + units.position;
  const std::string high = "position_max" + units.position;
  if (ignores_urdf_limits(yaml)) need_limits(yaml, units, joint->type != JointType::kContinuous);
  if (yaml.has(low)) {
    const double wanted = yaml.number(low, {-1e3, 1e3});
    if (!(wanted >= joint->position_min))
      yaml.refuse(low, fmt::format("{} is below the {} of the URDF{}", wanted, joint->position_min,
                                   unit_hint(low, wanted, joint->position_min, 0.0)));
    joint->position_min = wanted;
  }
  if (yaml.has(high)) {
    const double wanted = yaml.number(high, {-1e3, 1e3});
    if (!(wanted <= joint->position_max))
      yaml.refuse(high, fmt::format("{} is above the {} of the URDF{}", wanted, joint->position_max,
                                    unit_hint(high, wanted, 0.0, joint->position_max)));
    joint->position_max = wanted;
  }
  if (!(joint->position_min < joint->position_max)) {
    yaml.refuse(yaml.has(high) ? high : low,
                fmt::format("no room between {} and {}", joint->position_min, joint->position_max));
  }
  refuse_degrees(yaml, *joint, low, high);
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

void read_hold(const YamlMap& yaml, const JointUnits& units, DriveConfig* drive) {
  drive->hold_kp_Nm_per_rad =
      yaml.number("kp" + units.stiffness, {0.0, drive->range.kp_Nm_per_rad});
  drive->hold_kd_Nms_per_rad =
      yaml.number("kd" + units.damping, {0.0, drive->range.kd_Nms_per_rad});
  yaml.finish();
}

/// How the drive's coordinates lie in the joint's.
void read_mounting(const YamlMap& yaml, const JointUnits& units, DriveConfig* drive) {
  const long sign = yaml.integer_or("sign", -1, 1, 1);
  if (sign == 0) yaml.refuse("sign", "found '0'; expected 1 or -1");
  drive->sign = static_cast<double>(sign);
  drive->offset_rad = yaml.number_or("offset" + units.position, {-1e3, 1e3}, 0.0);
}

std::vector<std::string> names_of(const std::map<std::string, DriveConfig>& motors) {
  std::vector<std::string> names;
  names.reserve(motors.size());
  for (const auto& [name, motor] : motors) names.push_back(name);
  return names;
}

void read_antagonist(const YamlMap& yaml, const std::map<std::string, DriveConfig>& motors,
                     const JointUnits& units, const Robot& robot, std::size_t index,
                     JointConfig* joint) {
  joint->has_antagonist = true;
  joint->antagonist = motors.at(yaml.word_or("motor", names_of(motors), joint->drive.motor));
  if (joint->antagonist.protocol != joint->drive.protocol)
    yaml.refuse("motor", "has another protocol than the first motor");
  joint->antagonist.bus = joint->drive.bus;
  read_address(yaml, robot, index, &joint->antagonist);
  read_mounting(yaml, units, &joint->antagonist);
  yaml.finish();
}

FrameSizes frames_of(const JointConfig& joint, const Robot& robot) {
  const bool fd = robot.buses[static_cast<std::size_t>(joint.drive.bus)].fd;
  return joint.drive.protocol->frames(joint, fd);
}

void read_joint(const YamlMap& yaml, const std::map<std::string, DriveConfig>& motors,
                std::size_t index, Robot* robot) {
  JointConfig& joint = robot->joints[index];
  const JointUnits& units = units_of(joint);
  joint.drive = motors.at(yaml.word("motor", names_of(motors)));
  read_address(yaml, *robot, index, &joint.drive);
  read_mounting(yaml, units, &joint.drive);
  if (yaml.has("antagonist"))
    read_antagonist(yaml.map("antagonist"), motors, units, *robot, index, &joint);
  read_limits(yaml, &joint);
  check_drive_range(yaml, joint);
  joint.home = yaml.number("home" + units.position, {-1e3, 1e3});
  if (!(joint.home >= joint.position_min && joint.home <= joint.position_max)) {
    yaml.refuse("home" + units.position,
                fmt::format("{} is outside the limits {} to {}{}", joint.home, joint.position_min,
                            joint.position_max,
                            unit_hint("home" + units.position, joint.home, joint.position_min,
                                      joint.position_max)));
  }
  read_joint_chain(yaml, robot->rate_hz, &joint);
  joint.drive.frames = frames_of(joint, *robot);
  if (joint.has_antagonist) joint.antagonist.frames = frames_of(second_motor(joint), *robot);
  read_hold(yaml.map("hold"), units, &joint.drive);
  if (joint.has_antagonist) {
    joint.antagonist.hold_kp_Nm_per_rad = joint.drive.hold_kp_Nm_per_rad;
    joint.antagonist.hold_kd_Nms_per_rad = joint.drive.hold_kd_Nms_per_rad;
  }
  yaml.finish();
}

}  // namespace

bool ignores_urdf_limits(const YamlMap& joint) {
  return joint.word_or("urdf_limits", {"use", "ignore"}, "use") == "ignore";
}

void read_hand_drive(const YamlMap& yaml, const std::map<std::string, DriveConfig>& motors,
                     Robot* robot, JointConfig* drive) {
  if (robot->size() >= kMaxJoints)
    yaml.refuse(fmt::format("an arm with a hand has at most {} joints", kMaxJoints - 1));
  // Addresses are checked against those of all joints, of which it is the last for so long.
  Robot with = *robot;
  with.joints.push_back(*drive);
  JointConfig& joint = with.joints.back();
  joint.drive = motors.at(yaml.word("motor", names_of(motors)));
  read_address(yaml, with, with.joints.size() - 1, &joint.drive);
  const JointUnits& units = units_of(joint);
  read_mounting(yaml, units, &joint.drive);
  check_drive_range(yaml, joint);
  if (yaml.has("friction")) joint.friction = read_friction(yaml.map("friction"), units);
  joint.drive.frames = frames_of(joint, with);
  read_hold(yaml.map("hold"), units, &joint.drive);
  *drive = joint;
}

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
