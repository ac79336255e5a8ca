#include "robots/loader/motor_yaml.h"

#include <fmt/format.h>

#include <cmath>

#include "common/joints.h"
#include "robots/loader/actuator_yaml.h"
#include "robots/loader/adapter.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

void read_temperatures(const YamlMap& yaml, const DriveProtocol& protocol, DriveConfig* drive) {
  constexpr const char* kWarning = "warning_temperature_degC";
  constexpr const char* kLimit = "limit_temperature_degC";
  if (!std::isfinite(protocol.warning_temperature_degC)) {
    for (const char* key : {kWarning, kLimit}) {
      if (yaml.has(key))
        yaml.refuse(key, fmt::format("{} drives report no temperature, but warn by themselves",
                                     protocol.word));
    }
    return;
  }
  const double warning = yaml.number_or(kWarning, {20.0, 200.0}, protocol.warning_temperature_degC);
  const double limit = yaml.number_or(kLimit, {20.0, 200.0}, protocol.limit_temperature_degC);
  if (!(limit > warning)) {
    yaml.refuse(yaml.has(kLimit) ? kLimit : kWarning,
                fmt::format("the limit, {:g}, must be above the warning, {:g}", limit, warning));
  }
  drive->warning_temperature_degC = warning;
  drive->limit_temperature_degC = limit;
}

DriveConfig read_motor(const YamlMap& yaml, const std::string& name) {
  DriveConfig drive;
  drive.motor = name;
  yaml.text_or("description", "-");
  const DriveProtocol& protocol = protocol_named(yaml.word("protocol", protocol_words()));
  drive.protocol = &protocol;
  drive.gear_ratio = yaml.number("gear_ratio", {0.1, 1000.0});
  const double ratio_squared = drive.gear_ratio * drive.gear_ratio;
  drive.rotor_inertia_kgm2 = ratio_squared * yaml.number("rotor_inertia_kgm2", {0.0, 1.0});
  const double kt = yaml.number("rotor_torque_constant_Nm_per_A", {1e-4, 100.0});
  const double resistance = yaml.number("phase_resistance_ohm", {1e-4, 100.0});
  drive.torque_constant_Nm_per_A = drive.gear_ratio * kt;
  drive.short_circuit_damping_Nms = 2.0 / 3.0 * kt * kt / resistance * ratio_squared;
  drive.peak_torque_Nm = yaml.number("peak_torque_Nm", {0.01, 5e4});
  if (yaml.has("actuator")) drive.actuator = read_actuator(yaml.map("actuator"));
  drive.actuator.resistance_ohm = resistance;
  refuse_foreign_keys(yaml, protocol);
  read_temperatures(yaml, protocol, &drive);
  protocol.read_motor(yaml, &drive);
  yaml.finish();
  return drive;
}

BusConfig read_bus(const YamlMap& yaml) {
  BusConfig bus;
  bus.name = yaml.name("name");
  bus.can = yaml.text("can");
  const std::optional<CanAddress> address = can_address(bus.can);
  if (!address)
    yaml.refuse("can", fmt::format("found '{}'; expected {}", bus.can, kCanAddressForms));
  constexpr std::size_t kLongestInterface = 15;
  if (address->carrier == CanCarrier::kSocketCan && address->place.size() > kLongestInterface)
    yaml.refuse("can", "an interface name has at most 15 letters");
  bus.fd = yaml.boolean_or("fd", false);
  bus.bitrate_bps = static_cast<int>(yaml.integer("bitrate_bps", 10'000, 1'000'000));
  if (bus.fd) {
    bus.data_bitrate_bps =
        static_cast<int>(yaml.integer("data_bitrate_bps", bus.bitrate_bps, 8'000'000));
  } else {
    yaml.leave_to("fd: true", {"data_bitrate_bps"});
  }
  const AdapterTiming& usual = timing_of(adapter_of(bus.can, CanAdapter::kNative));
  std::vector<std::string> adapters;
  for (const AdapterTiming& adapter : kAdapters) adapters.emplace_back(adapter.word);
  const std::string word = yaml.word_or("adapter", adapters, std::string(usual.word));
  for (const AdapterTiming& adapter : kAdapters) {
    if (adapter.word == word) bus.adapter = adapter.adapter;
  }
  if (address->serial() && word != usual.word)
    yaml.refuse("adapter", fmt::format("{} is an adapter of the class {}", bus.can, usual.word));
  if (bus.fd && !timing_of(bus.adapter).fd) yaml.refuse("adapter", word + " carries no CAN-FD");
  bus.reply_window_s = yaml.number_or("reply_window_s", {1e-5, 1.0}, 0.0);
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
