#include "robots/loader/tip_sensor_yaml.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <kdl/frames.hpp>

#include "common/complaints.h"
#include "robots/loader/address_yaml.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

constexpr double kMostForce_N = 1e5;
constexpr double kMostTorque_Nm = 1e4;

/// `name: {force_N: ..., torque_Nm: ...}`, one number each or three.
SixAxes read_axes(const YamlMap& yaml, double least_N, double least_Nm) {
  const auto force = yaml.numbers("force_N", 3, {least_N, kMostForce_N}, true);
  const auto torque = yaml.numbers("torque_Nm", 3, {least_Nm, kMostTorque_Nm}, true);
  SixAxes axes{};
  std::copy(force.begin(), force.end(), axes.begin());
  std::copy(torque.begin(), torque.end(), axes.begin() + 3);
  return axes;
}

SixAxes read_optional_axes(const YamlMap& yaml, const std::string& key, double least_N,
                           double least_Nm) {
  if (!yaml.has(key)) return {};
  const YamlMap section = yaml.map(key);
  const SixAxes axes = read_axes(section, least_N, least_Nm);
  section.finish();
  return axes;
}

void read_quaternion(const YamlMap& yaml, double* out) {
  const auto wxyz = yaml.numbers("quaternion_wxyz", 4, {-1.001, 1.001});
  const double norm =
      std::sqrt(wxyz[0] * wxyz[0] + wxyz[1] * wxyz[1] + wxyz[2] * wxyz[2] + wxyz[3] * wxyz[3]);
  if (!(norm >= 0.999 && norm <= 1.001))
    yaml.refuse("quaternion_wxyz", fmt::format("has length {:.4f}; expected 1", norm));
  for (std::size_t i = 0; i < 4; ++i) out[i] = wxyz[i] / norm;
}

/// Roll, pitch, yaw about fixed axes, as in URDF.
void read_rpy(const YamlMap& yaml, double* out) {
  const auto rpy = yaml.numbers("rpy_rad", 3, {-6.3, 6.3});
  KDL::Rotation::RPY(rpy[0], rpy[1], rpy[2]).GetQuaternion(out[1], out[2], out[3], out[0]);
}

void read_pose(const YamlMap& yaml, TipSensorConfig* sensor) {
  const auto p = yaml.numbers("position_m", 3, {-1.0, 1.0});
  std::copy(p.begin(), p.end(), sensor->p_TS);
  const bool quaternion = yaml.has("quaternion_wxyz");
  if (quaternion == yaml.has("rpy_rad"))
    yaml.refuse("expected either 'rpy_rad' or 'quaternion_wxyz'");
  quaternion ? read_quaternion(yaml, sensor->quat_TS) : read_rpy(yaml, sensor->quat_TS);
  yaml.finish();
}

void read_tool(const YamlMap& yaml, TipSensorConfig* sensor) {
  sensor->tool_mass_kg = yaml.number("mass_kg", {0.0, 100.0});
  const auto com = yaml.numbers("centre_of_mass_m", 3, {-1.0, 1.0});
  std::copy(com.begin(), com.end(), sensor->p_SC);
  yaml.finish();
}

void read_noise(const YamlMap& yaml, TipSensorConfig* sensor) {
  sensor->noise_seed = static_cast<std::uint32_t>(yaml.integer_or("seed", 0, 1'000'000'000, 1));
  sensor->noise = read_axes(yaml, 0.0, 0.0);
  yaml.finish();
}

TipSensorProtocol read_protocol(const YamlMap& yaml) {
  std::vector<std::string> words;
  for (const TipSensorTraits& traits : kTipSensorProtocols) words.emplace_back(traits.word);
  const std::string word = yaml.word("protocol", words);
  return std::ranges::find(kTipSensorProtocols, word, &TipSensorTraits::word)->protocol;
}

/// Bus and protocol must fit each other.
void read_wire(const YamlMap& yaml, const Robot& robot, TipSensorConfig* sensor) {
  sensor->protocol = read_protocol(yaml);
  const TipSensorTraits& traits = traits_of(sensor->protocol);
  sensor->bus = read_bus(yaml, robot);
  const BusConfig& bus = robot.buses[static_cast<std::size_t>(sensor->bus)];
  if (!traits.fd && bus.fd) {
    yaml.refuse("bus", fmt::format("'{}' is a CAN-FD bus, whose frames a {} sensor would destroy; "
                                   "expected a classic bus",
                                   bus.name, traits.word));
  }
  if (traits.fd && !bus.fd) {
    yaml.refuse("bus",
                fmt::format("'{}' is a classic bus; {} needs fd: true", bus.name, traits.word));
  }
  if (!traits.counts) {
    yaml.leave_to("protocol: robotous_rft", {"counts_per_N", "counts_per_Nm"});
    return;
  }
  sensor->counts_per_N = yaml.number_or("counts_per_N", {0.1, 1e5}, sensor->counts_per_N);
  sensor->counts_per_Nm = yaml.number_or("counts_per_Nm", {0.1, 1e6}, sensor->counts_per_Nm);
}

void check_free(const YamlMap& yaml, const std::string& key, std::uint32_t id, const Robot& robot,
                int bus) {
  for (const JointConfig& joint : robot.driven()) {
    for (int motor = 0; motor < joint.motors(); ++motor) {
      const DriveConfig& drive = joint.motor(motor);
      if (drive.bus != bus) continue;
      if (uses_id(drive, id))
        yaml.refuse(key, fmt::format("{} is taken by {} on the same bus", id, joint.name));
      if (accepts_id(drive, id))
        yaml.refuse(key, fmt::format("{} would reach {} on the same bus: a {} drive accepts more "
                                     "identifiers than its own",
                                     id, joint.name, drive.protocol->word));
    }
  }
}

void read_ids(const YamlMap& yaml, const Robot& robot, TipSensorConfig* sensor) {
  sensor->command_id = static_cast<std::uint32_t>(yaml.integer("id", 1, kMostId));
  const bool two = sensor->replies() == 2;
  const std::string key = two ? "reply_ids" : "reply_id";
  yaml.leave_to(two ? "protocol: limber_ft" : "protocol: robotous_rft",
                {two ? "reply_id" : "reply_ids"});
  if (two) {
    const auto ids = yaml.numbers(key, 2, {1.0, kMostId});
    for (std::size_t i = 0; i < 2; ++i) {
      sensor->reply_ids[i] = static_cast<std::uint32_t>(ids[i]);
      if (sensor->reply_ids[i] != ids[i]) yaml.refuse(key, "expected two whole numbers");
    }
    if (sensor->reply_ids[0] == sensor->reply_ids[1]) yaml.refuse(key, "must differ");
  } else {
    sensor->reply_ids[0] = static_cast<std::uint32_t>(yaml.integer(key, 1, kMostId));
  }
  check_free(yaml, "id", sensor->command_id, robot, sensor->bus);
  for (int i = 0; i < sensor->replies(); ++i) {
    const std::uint32_t id = sensor->reply_ids[static_cast<std::size_t>(i)];
    if (id == sensor->command_id) yaml.refuse(key, "must differ from id");
    check_free(yaml, key, id, robot, sensor->bus);
  }
}

/// A count field that is full before the sensor is would hide the overload.
void check_range(const YamlMap& yaml, const TipSensorConfig& sensor) {
  if (!traits_of(sensor.protocol).counts) return;
  for (std::size_t i = 0; i < 6; ++i) {
    const double most = 32767.0 / (i < 3 ? sensor.counts_per_N : sensor.counts_per_Nm);
    if (sensor.range[i] <= most) continue;
    yaml.refuse(
        i < 3 ? "force_N" : "torque_Nm",
        fmt::format("{} is more than the {:.4g} that 16 bits can carry", sensor.range[i], most));
  }
}

}  // namespace

void read_tip_sensor(const YamlMap& yaml, Robot* robot) {
  TipSensorConfig sensor;
  Complaints complaints(yaml.file());
  sensor.model = yaml.text("model");
  const bool wired = complaints.collect([&] { read_wire(yaml, *robot, &sensor); });
  if (wired) complaints.collect([&] { read_ids(yaml, *robot, &sensor); });
  complaints.collect([&] { read_pose(yaml.map("pose"), &sensor); });
  complaints.collect([&] {
    const YamlMap range = yaml.map("range");
    sensor.range = read_axes(range, 0.1, 0.001);
    range.finish();
    check_range(range, sensor);
  });
  complaints.collect([&] {
    sensor.resolution = read_optional_axes(yaml, "resolution", 0.0, 0.0);
    sensor.bias = read_optional_axes(yaml, "bias", -kMostForce_N, -kMostTorque_Nm);
    if (yaml.has("noise")) read_noise(yaml.map("noise"), &sensor);
    sensor.filter_time_constant_s = yaml.number_or("filter_time_constant_s", {0.0, 1.0}, 0.0);
  });
  if (yaml.has("tool")) complaints.collect([&] { read_tool(yaml.map("tool"), &sensor); });
  if (!complaints.any()) complaints.collect([&] { yaml.finish(); });
  complaints.throw_if_any();
  robot->tip_sensor = sensor;
  robot->has_tip_sensor = true;
}

}  // namespace limber
