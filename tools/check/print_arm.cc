#include <fmt/format.h>

#include <sstream>

#include "robots/loader/adapter.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "sim/wire/bus_timeline.h"
#include "tools/check/chain_report.h"
#include "tools/check/json.h"
#include "tools/check/print.h"
#include "tools/check/robot_json.h"

namespace limber {
namespace {

std::string bus_text(const BusConfig& bus, const BusReport& report, double rate_hz) {
  const std::string speed = bus.fd ? fmt::format("CAN-FD {:g}/{:g} Mbit/s", bus.bitrate_bps * 1e-6,
                                                 bus.data_bitrate_bps * 1e-6)
                                   : fmt::format("CAN {:g} Mbit/s", bus.bitrate_bps * 1e-6);
  std::string rates;
  for (std::size_t i = 0; i < kAdapters.size(); ++i) {
    if (report.highest_rate_hz[i] > 0.0)
      rates += fmt::format("{}{} {:.0f} Hz", rates.empty() ? "" : ", ", kAdapters[i].word,
                           std::floor(report.highest_rate_hz[i]));
  }
  return fmt::format(
      "  {}  {}  {}: {:.1f} % busy at {} Hz (at most {:.1f} %), last reply after {:.2f} ms of "
      "{:.2f} ms; "
      "highest rate by adapter: {}\n",
      bus.name, bus.can, speed, 100.0 * report.load, rate_hz, 100.0 * report.most_load,
      1e3 * report.end_s, 1e3 * report.window_s, rates);
}

std::string tip_sensor_text(const Robot& robot) {
  const TipSensorConfig& sensor = robot.tip_sensor;
  return fmt::format(
      "  tip sensor: {} on {}, id {}; +-{:g} N, +-{:g} N m along its z; tool behind it {:g} kg\n",
      sensor.model, robot.buses[static_cast<std::size_t>(sensor.bus)].name, sensor.command_id,
      sensor.range[2], sensor.range[5], sensor.tool_mass_kg);
}

// As the makers' tools write them: hexadecimal, or the node numbers of CANopen and moteus, whose
// frames have more fields.
std::string as_seen(const DriveConfig& drive, std::uint32_t id) {
  const bool node = !drive.protocol->hex_ids && id <= 0xFF;
  return node ? fmt::format("{}", id) : fmt::format("{:#04x}", id);
}

std::string joint_table(const Robot& robot, const ArmReport& report) {
  std::string table =
      fmt::format("  {:<14} {:<10} {:>9} {:>9} {:>8} {:>8} {:>9} {:>9} {:>9}", "joint", "type",
                  "min", "max", "speed", "torque", "home", "g home", "g worst");
  table += robot.has_drives ? "  motor, bus, id/reply\n" : "\n";
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const JointConfig& joint = robot.joints[i];
    table += fmt::format(
        "  {:<14} {:<10} {:>9.4f} {:>9.4f} {:>8.3f} {:>8.2f} {:>9.4f} {:>9.3f} {:>9.3f}",
        joint.name, type_name(joint.type), joint.position_min, joint.position_max,
        joint.velocity_limit, joint.torque_limit_Nm, joint.home, report.home_gravity_Nm[i],
        report.worst_gravity_Nm[i]);
    if (robot.has_drives) {
      const DriveConfig& drive = joint.drive;
      table += fmt::format("  {}, {}, {}/{}", drive.motor,
                           robot.buses[static_cast<std::size_t>(drive.bus)].name,
                           as_seen(drive, drive.command_id), as_seen(drive, drive.reply_id));
      if (joint.has_antagonist)
        table += fmt::format(" and {}", as_seen(drive, joint.antagonist.command_id));
    }
    table += "\n";
  }
  return table;
}

std::string hand_text(const Robot& robot) {
  const HandConfig& hand = *robot.hand;
  const DriveConfig& drive = hand.drive.drive;
  return fmt::format(
      "  hand {:g} to {:g} m wide, {:g} N (holds with {:.4g}), {:g} m/s: {}, {}, {}/{}\n",
      hand.travel.closed_m(), hand.travel.open_m(), hand.force_limit_N, hand.hold_force_N,
      hand.speed_limit_m_per_s, drive.motor, robot.buses[static_cast<std::size_t>(drive.bus)].name,
      as_seen(drive, drive.command_id), as_seen(drive, drive.reply_id));
}

std::string joint_json(const Robot& robot, const ArmReport& report, std::size_t i) {
  json::Members members = joint_members(robot, robot.joints[i]);
  members.emplace_back("home_gravity_Nm", json::number(report.home_gravity_Nm[i]));
  members.emplace_back("worst_gravity_Nm", json::number(report.worst_gravity_Nm[i]));
  return json::object(members);
}

}  // namespace

std::string arm_text(const LoadedRobot& robot, const ArmReport& report) {
  const Robot& arm = robot.robot;
  std::string text = fmt::format(
      "{}: {} joints from {} to {}, {:.4g} kg moving, gravity [{:.4g}, {:.4g}, {:.4g}] m/s^2 in "
      "base "
      "axes\n",
      arm.name, arm.size(), arm.base, arm.tip, report.moving_mass_kg, arm.gravity[0],
      arm.gravity[1], arm.gravity[2]);
  text += "  rad, rad/s, N m (prismatic: m, m/s, N); g: torque against gravity\n";
  text += joint_table(arm, report);
  text += chain_table(arm);
  const auto& p = report.home_p_BT;
  const auto& q = report.home_quat_BT;
  text += fmt::format(
      "  tip at home: [{:.4f}, {:.4f}, {:.4f}] m, quaternion wxyz [{:.4f}, {:.4f}, {:.4f}, "
      "{:.4f}]\n",
      p[0], p[1], p[2], q[0], q[1], q[2], q[3]);
  for (std::size_t i = 0; i < report.buses.size(); ++i)
    text += bus_text(arm.buses[i], report.buses[i], arm.rate_hz);
  if (arm.has_tip_sensor) text += tip_sensor_text(arm);
  if (arm.hand) text += hand_text(arm);
  for (const std::string& warning : report.warnings) text += "  warning: " + warning + "\n";
  for (const std::string& note : robot.notes) text += "  note: " + note + "\n";
  return text;
}

auto adapter_rates(const BusReport& report) {
  std::vector<std::pair<std::string, std::string>> rates;
  for (std::size_t i = 0; i < kAdapters.size(); ++i)
    rates.emplace_back(kAdapters[i].word, json::number(std::floor(report.highest_rate_hz[i])));
  return rates;
}

// One cycle on the simulated wire, frame by frame.
std::string timeline_json(const Robot& robot, int bus) {
  std::vector<std::string> frames;
  for (const sim::FrameTimes& frame : sim::bus_timeline(robot, bus)) {
    frames.push_back(json::object({{"name", json::text(frame.name)},
                                   {"id", json::number(frame.id)},
                                   {"reply", frame.reply ? "true" : "false"},
                                   {"start_s", json::number(frame.start_s)},
                                   {"end_s", json::number(frame.end_s)}}));
  }
  return json::list(frames);
}

std::string bus_json(const Robot& robot, const BusReport& report, std::size_t i) {
  json::Members members = bus_members(robot.buses[i]);
  members.insert(members.end(), {{"predicted_load", json::number(report.load)},
                                 {"predicted_end_s", json::number(report.end_s)},
                                 {"reply_window_s", json::number(report.window_s)},
                                 {"highest_rate_hz", json::object(adapter_rates(report))},
                                 {"cycle", timeline_json(robot, static_cast<int>(i))}});
  return json::object(members);
}

std::string arm_json(const LoadedRobot& robot, const ArmReport& report) {
  const Robot& arm = robot.robot;
  std::vector<std::string> joints;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) joints.push_back(joint_json(arm, report, i));
  std::vector<std::string> buses;
  for (std::size_t i = 0; i < report.buses.size(); ++i)
    buses.push_back(bus_json(arm, report.buses[i], i));
  json::Members members = robot_members(robot);
  members.insert(members.begin(), {"ok", "true"});
  members.insert(members.end(), {{"moving_mass_kg", json::number(report.moving_mass_kg)},
                                 {"home_p_BT", json::numbers(report.home_p_BT)},
                                 {"home_quat_BT", json::numbers(report.home_quat_BT)},
                                 {"joints", json::list(joints)},
                                 {"buses", json::list(buses)},
                                 {"warnings", json::texts(report.warnings)}});
  return json::object(members) + "\n";
}

std::string refusal_json(const std::string& what) {
  std::vector<std::string> complaints;
  std::istringstream lines(what);
  for (std::string line; std::getline(lines, line);) complaints.push_back(line);
  return json::object({{"ok", "false"}, {"complaints", json::texts(complaints)}}) + "\n";
}

}  // namespace limber
