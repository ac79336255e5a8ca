#include "tools/check/robot_json.h"

#include "robots/loader/protocols/drive_protocol.h"
#include "tools/check/chain_report.h"
#include "tools/check/tree_json.h"

namespace limber {
namespace {

std::string tip_sensor_json(const Robot& robot) {
  if (!robot.has_tip_sensor) return "null";
  const TipSensorConfig& sensor = robot.tip_sensor;
  std::vector<double> replies(sensor.reply_ids.begin(),
                              sensor.reply_ids.begin() + sensor.replies());
  return json::object({{"model", json::text(sensor.model)},
                       {"bus", json::text(robot.buses[static_cast<std::size_t>(sensor.bus)].name)},
                       {"id", json::number(sensor.command_id)},
                       {"reply_ids", json::numbers(replies)},
                       {"range_N_Nm", json::numbers({sensor.range.begin(), sensor.range.end()})},
                       {"tool_mass_kg", json::number(sensor.tool_mass_kg)}});
}

std::string hand_json(const Robot& robot) {
  if (!robot.hand) return "null";
  const HandConfig& hand = *robot.hand;
  std::vector<double> widths;
  std::vector<double> angles;
  for (std::size_t i = 0; i < hand.travel.count; ++i) {
    widths.push_back(hand.travel.points[i].width_m);
    angles.push_back(hand.travel.points[i].angle_rad);
  }
  return json::object({{"drive", json::object(joint_members(robot, hand.drive))},
                       {"width_m", json::numbers(widths)},
                       {"angle_rad", json::numbers(angles)},
                       {"stiffness_N_per_m", json::number(hand.stiffness_N_per_m)},
                       {"damping_Ns_per_m", json::number(hand.damping_Ns_per_m)},
                       {"force_limit_N", json::number(hand.force_limit_N)},
                       {"speed_limit_m_per_s", json::number(hand.speed_limit_m_per_s)},
                       {"hold_force_N", json::number(hand.hold_force_N)},
                       {"continuous_torque_Nm", json::number(hand.rated_torque_Nm)},
                       {"heat_time_constant_s", json::number(hand.heat_time_constant_s)},
                       {"finger_mass_kg", json::number(hand.finger_mass_kg)},
                       {"grasp_point_m", json::numbers({hand.p_TG, hand.p_TG + 3})}});
}

std::string gains_json(const DefaultGains& gains) {
  return json::object({{"K_q_Nm_per_rad", json::numbers(gains.K_q)},
                       {"joint_damping_ratio", json::number(gains.joint_damping_ratio)},
                       {"K_x_translation_N_per_m", json::number(gains.K_x_translation_N_per_m)},
                       {"K_x_rotation_Nm_per_rad", json::number(gains.K_x_rotation_Nm_per_rad)},
                       {"damping_ratio", json::number(gains.damping_ratio)},
                       {"K_null_Nm_per_rad", json::numbers(gains.K_null)},
                       {"D_null_Nms_per_rad", json::numbers(gains.D_null)}});
}

json::Members drive_members(const Robot& robot, const DriveConfig& drive) {
  return {{"motor", json::text(drive.motor)},
          {"protocol", json::text(std::string(drive.protocol->word))},
          {"bus", json::text(robot.buses[static_cast<std::size_t>(drive.bus)].name)},
          {"id", json::number(drive.command_id)},
          {"reply_id", json::number(drive.reply_id)},
          {"limit_temperature_degC", json::number(drive.limit_temperature_degC)},
          {"rotor_inertia_kgm2", json::number(drive.rotor_inertia_kgm2)},
          {"torque_constant_Nm_per_A", json::number(drive.torque_constant_Nm_per_A)},
          {"short_circuit_damping_Nms", json::number(drive.short_circuit_damping_Nms)}};
}

}  // namespace

const char* type_name(JointType type) {
  switch (type) {
    case JointType::kRevolute:
      return "revolute";
    case JointType::kContinuous:
      return "continuous";
    case JointType::kPrismatic:
      return "prismatic";
  }
  return "";
}

json::Members joint_members(const Robot& robot, const JointConfig& joint) {
  json::Members members = {
      {"name", json::text(joint.name)},
      {"type", json::text(type_name(joint.type))},
      {"position_min", json::number(joint.position_min)},
      {"position_max", json::number(joint.position_max)},
      {"velocity_limit", json::number(joint.velocity_limit)},
      {"torque_limit_Nm", json::number(joint.torque_limit_Nm)},
      {"torque_rate_limit_Nm_per_s", json::number(joint.torque_rate_limit_Nm_per_s)},
      {"home", json::number(joint.home)}};
  if (!robot.has_drives) return members;
  for (const json::Members& more : {drive_members(robot, joint.drive), chain_members(joint)})
    members.insert(members.end(), more.begin(), more.end());
  return members;
}

json::Members bus_members(const BusConfig& bus) {
  return {{"name", json::text(bus.name)},
          {"can", json::text(bus.can)},
          {"fd", json::flag(bus.fd)},
          {"bitrate_bps", json::number(bus.bitrate_bps)},
          {"data_bitrate_bps", json::number(bus.data_bitrate_bps)}};
}

json::Members robot_members(const LoadedRobot& loaded) {
  const Robot& robot = loaded.robot;
  return {
      {"name", json::text(robot.name)},
      {"folder", json::text(robot.folder)},
      {"urdf", json::text(robot.urdf_path)},
      {"base", json::text(robot.base)},
      {"tip", json::text(robot.tip)},
      {"links", json::texts(loaded.segment_links)},
      {"rate_hz", json::number(robot.rate_hz)},
      {"energy_limit_J", json::number(robot.energy_limit_J)},
      {"gravity_m_per_s2", json::numbers({robot.gravity[0], robot.gravity[1], robot.gravity[2]})},
      {"tip_sensor", tip_sensor_json(robot)},
      {"hand", hand_json(robot)},
      {"notes", json::texts(loaded.notes)}};
}

std::string robot_json(const LoadedRobot& loaded) {
  const Robot& robot = loaded.robot;
  std::vector<std::string> joints;
  for (const JointConfig& joint : robot.joints)
    joints.push_back(json::object(joint_members(robot, joint)));
  std::vector<std::string> buses;
  for (const BusConfig& bus : robot.buses) buses.push_back(json::object(bus_members(bus)));
  json::Members members = robot_members(loaded);
  members.insert(members.begin(), {"format", json::text("limber-resolved-robot/1")});
  members.insert(members.end(), {{"joints", json::list(joints)},
                                 {"buses", json::list(buses)},
                                 {"gains", gains_json(robot.gains)},
                                 {"tree", tree_json(*loaded.model)}});
  return json::object(members);
}

}  // namespace limber
