#include "robots/motor_yaml.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/joints.h"
#include "robots/actuator_yaml.h"

namespace limber {
namespace {

CommandRange read_range(const YamlMap& yaml) {
  CommandRange range;
  range.position_rad = yaml.number("position_rad", {1.0, 200.0});
  range.velocity_rad_per_s = yaml.number("velocity_rad_per_s", {0.1, 1000.0});
  range.torque_Nm = yaml.number("torque_Nm", {0.01, 2000.0});
  range.kp_Nm_per_rad = yaml.number("kp_Nm_per_rad", {1.0, 5000.0});
  range.kd_Nms_per_rad = yaml.number("kd_Nms_per_rad", {0.01, 500.0});
  yaml.finish();
  return range;
}

/// Refuses keys that only motors of another protocol have.
void refuse_keys_of(const YamlMap& yaml, const std::string& protocol,
                    const std::vector<std::string>& keys) {
  for (const std::string& key : keys) {
    if (yaml.has(key))
      yaml.refuse(key, fmt::format("is for motors with protocol: {} only", protocol));
  }
}

void read_damiao(const YamlMap& yaml, DriveConfig* drive) {
  refuse_keys_of(yaml, "moteus", {"pid_position", "timeout_torque_Nm"});
  refuse_keys_of(yaml, "cia402", {"rated_torque_Nm"});
  drive->protocol = DriveProtocol::kDamiaoMit;
  drive->range = read_range(yaml.map("mit_range"));
  drive->encoder_bits = static_cast<int>(yaml.integer("encoder_bits", 8, 24));
  if (!(drive->peak_torque_Nm <= drive->range.torque_Nm)) {
    yaml.refuse("peak_torque_Nm",
                fmt::format("{} is more than the {} the torque field can carry (mit_range)",
                            drive->peak_torque_Nm, drive->range.torque_Nm));
  }
}

constexpr double kNoEnd = std::numeric_limits<double>::infinity();

/// Floats carry everything; kp and kd go as a share of what is configured in the drive.
void read_moteus(const YamlMap& yaml, DriveConfig* drive) {
  refuse_keys_of(yaml, "damiao_mit", {"mit_range"});
  refuse_keys_of(yaml, "cia402", {"rated_torque_Nm"});
  drive->protocol = DriveProtocol::kMoteus;
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  const YamlMap gains = yaml.map("pid_position");
  drive->range = {kNoEnd, kNoEnd, kNoEnd, gains.number("kp_Nm_per_turn", {1e-3, 1e5}) / kTurn_rad,
                  gains.number("kd_Nms_per_turn", {1e-3, 1e4}) / kTurn_rad};
  gains.finish();
  drive->timeout_torque_Nm =
      yaml.number_or("timeout_torque_Nm", {0.0, drive->peak_torque_Nm},
                     std::min(drive->timeout_torque_Nm, drive->peak_torque_Nm));
  drive->encoder_bits = static_cast<int>(yaml.integer("encoder_bits", 8, 32));
  drive->command_bytes = 48;
  drive->reply_bytes = 32;
}

/// Torques are 16-bit thousandths of the rated torque; the driver makes stiffness and damping.
void read_cia402(const YamlMap& yaml, DriveConfig* drive) {
  refuse_keys_of(yaml, "damiao_mit", {"mit_range"});
  refuse_keys_of(yaml, "moteus", {"pid_position", "timeout_torque_Nm"});
  drive->protocol = DriveProtocol::kCia402;
  drive->rated_torque_Nm = yaml.number("rated_torque_Nm", {0.001, 1e4});
  constexpr double kMost = 32.767;  // times the rated torque
  drive->range = {kNoEnd, kNoEnd, kMost * drive->rated_torque_Nm, kNoEnd, kNoEnd};
  if (!(drive->peak_torque_Nm <= drive->range.torque_Nm)) {
    yaml.refuse("rated_torque_Nm",
                fmt::format("{} cannot carry the peak torque of {}: 32767 thousandths are {:.4g}",
                            drive->rated_torque_Nm, drive->peak_torque_Nm, drive->range.torque_Nm));
  }
  drive->encoder_bits = static_cast<int>(yaml.integer("encoder_bits", 8, 28));
  drive->command_bytes = 4;
  drive->reply_bytes = 16;
}

DriveConfig read_motor(const YamlMap& yaml, const std::string& name) {
  DriveConfig drive;
  drive.motor = name;
  yaml.text_or("description", "-");
  const std::string protocol = yaml.word("protocol", {"damiao_mit", "moteus", "cia402"});
  drive.gear_ratio = yaml.number("gear_ratio", {0.1, 1000.0});
  const double ratio_squared = drive.gear_ratio * drive.gear_ratio;
  drive.rotor_inertia_kgm2 = ratio_squared * yaml.number("rotor_inertia_kgm2", {0.0, 1.0});
  const double kt = yaml.number("rotor_torque_constant_Nm_per_A", {1e-4, 100.0});
  const double resistance = yaml.number("phase_resistance_ohm", {1e-4, 100.0});
  drive.torque_constant_Nm_per_A = drive.gear_ratio * kt;
  drive.short_circuit_damping_Nms = 2.0 / 3.0 * kt * kt / resistance * ratio_squared;
  drive.peak_torque_Nm = yaml.number("peak_torque_Nm", {0.01, 2000.0});
  if (yaml.has("actuator")) drive.actuator = read_actuator(yaml.map("actuator"));
  drive.actuator.resistance_ohm = resistance;
  if (protocol == "damiao_mit") read_damiao(yaml, &drive);
  if (protocol == "moteus") read_moteus(yaml, &drive);
  if (protocol == "cia402") read_cia402(yaml, &drive);
  yaml.finish();
  return drive;
}

BusConfig read_bus(const YamlMap& yaml) {
  BusConfig bus;
  bus.name = yaml.text("name");
  bus.can = yaml.text("can");
  const auto colon = bus.can.find(':');
  const std::string kind = bus.can.substr(0, colon);
  if (colon == std::string::npos || (kind != "virtual" && kind != "socketcan") ||
      bus.can.size() == colon + 1) {
    yaml.refuse("can",
                fmt::format("found '{}'; expected virtual:NAME or socketcan:INTERFACE", bus.can));
  }
  constexpr std::size_t kLongestInterface = 15;
  if (kind == "socketcan" && bus.can.size() - colon - 1 > kLongestInterface)
    yaml.refuse("can", "an interface name has at most 15 letters");
  bus.fd = yaml.boolean_or("fd", false);
  bus.bitrate_bps = static_cast<int>(yaml.integer("bitrate_bps", 10'000, 1'000'000));
  if (bus.fd) {
    bus.data_bitrate_bps =
        static_cast<int>(yaml.integer("data_bitrate_bps", bus.bitrate_bps, 8'000'000));
  }
  yaml.finish();
  return bus;
}

}  // namespace

std::map<std::string, DriveConfig> read_motors(const YamlMap& yaml) {
  const YamlMap section = yaml.map("motors");
  std::map<std::string, DriveConfig> motors;
  for (const std::string& name : section.keys())
    motors.emplace(name, read_motor(section.map(name), name));
  return motors;
}

std::vector<BusConfig> read_buses(const YamlMap& yaml) {
  std::vector<BusConfig> buses;
  for (const YamlMap& entry : yaml.maps("buses")) {
    buses.push_back(read_bus(entry));
    for (std::size_t i = 0; i + 1 < buses.size(); ++i) {
      if (buses[i].name == buses.back().name) entry.refuse("name", "is taken by another bus");
      if (buses[i].can == buses.back().can)
        entry.refuse("can", fmt::format("bus '{}' is on it already", buses[i].name));
    }
  }
  if (buses.empty() || buses.size() > kMaxBuses)
    yaml.refuse("buses", fmt::format("found {}; expected 1 to {}", buses.size(), kMaxBuses));
  return buses;
}

}  // namespace limber
