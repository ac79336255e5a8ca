#include "robots/loader/required_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <vector>

#include "common/complaints.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

const RequiredKey kOfEveryRobot[] = {
    {"", "format", "", "`limber-robot/1`"},
    {"", "name", "", "of the arm, for people"},
    {"", "urdf", "", "file beside robot.yaml: `robot.urdf`"},
    {"", "base", "", "link of the URDF that the arm is fixed by"},
    {"", "tip", "", "link of the URDF that the arm works with"},
    {"", "rate_hz", "", "control rate; 1000 where the bus carries it"},
    {"", "buses", "", "list of the CAN buses"},
    {"", "watchdog", "", "what the drives do without commands"},
    {"", "motors", "", "one entry a model of motor"},
    {"", "joints", "", "one entry a joint, named as in the URDF"},
    {"", "gains", "", "what the controller starts with"},
    {"buses[]", "name", "", "that the joints name it by"},
    {"buses[]", "can", "",
     "`virtual:NAME` (simulated), `socketcan:INTERFACE`, `slcan:/dev/NAME` or "
     "`dmserial:/dev/NAME`"},
    {"buses[]", "bitrate_bps", "", "bit rate; of CAN-FD in the arbitration phase"},
    {"buses[]", "data_bitrate_bps", "fd: true", "bit rate of CAN-FD's data phase"},
    {"watchdog", "timeout_s", "", "without a command for so long, a drive stops by itself"},
    {"watchdog", "reaction", "", "of the simulated drives: `damp` or `off`"},
    {"motors.*", "protocol", "", "of its drive"},
    {"motors.*", "gear_ratio", "", "rotor turns per turn of the joint"},
    {"motors.*", "rotor_inertia_kgm2", "", "of the rotor itself, before the gear"},
    {"motors.*", "rotor_torque_constant_Nm_per_A", "", "before the gear"},
    {"motors.*", "phase_resistance_ohm", "", "of the winding"},
    {"motors.*", "peak_torque_Nm", "", "largest torque of the drive, at the joint"},
    {"joints.*", "motor", "", "name of one of the motors"},
    {"joints.*", "bus", "", "name of one of the buses"},
    {"joints.*", "id", "", "number of the drive on its bus, as 1 or 0x01"},
    {"joints.*", "home_rad|home_m", "", "pose that scenarios and the simulator start from"},
    {"joints.*", "hold", "", "how the driver holds the joint without a controller"},
    {"joints.*.hold", "kp_Nm_per_rad|kp_N_per_m", "", "stiffness of holding"},
    {"joints.*.hold", "kd_Nms_per_rad|kd_Ns_per_m", "", "damping of holding"},
    {"hand", "motor", "", "of an arm with a hand: name of one of the motors"},
    {"hand", "bus", "", "name of one of the buses"},
    {"hand", "id", "", "number of its drive on the bus"},
    {"hand", "travel", "", "width between the fingers against angle of the motor"},
    {"hand", "stiffness_N_per_m", "", "of the width"},
    {"hand", "damping_Ns_per_m", "", "of the width"},
    {"hand", "force_limit_N", "", "most that each finger presses with"},
    {"hand", "speed_limit_m_per_s", "", "most that the width changes by"},
    {"hand", "velocity_limit_rad_per_s", "", "of the motor, behind its gear; faster is a fault"},
    {"hand", "continuous_torque_Nm", "", "that the motor makes for ever"},
    {"hand", "heat_time_constant_s", "", "of the motor's winding"},
    {"hand", "hold", "", "as of a joint"},
    {"hand.travel", "width_m", "", "list, rising, from closed to open"},
    {"hand.travel", "angle_rad", "", "list of as many angles, monotone"},
    {"hand.hold", "kp_Nm_per_rad", "", "stiffness of holding"},
    {"hand.hold", "kd_Nms_per_rad", "", "damping of holding"},
    {"gains", "K_q_Nm_per_rad", "", "joint stiffness; one number or one a joint"},
    {"gains", "joint_damping_ratio", "", "of the joint stiffness; 0.7 settles fast"},
    {"gains", "K_x_translation_N_per_m", "", "stiffness of the tip"},
    {"gains", "K_x_rotation_Nm_per_rad", "", "stiffness of the tip's orientation"},
    {"gains", "damping_ratio", "", "of the tip's stiffness"},
    {"gains", "K_null_Nm_per_rad", "", "stiffness of the null space; one number or one a joint"},
    {"gains", "D_null_Nms_per_rad", "", "damping of the null space; one number or one a joint"},
};

/// Those of a section, or of a mapping in it, that motors or joints of one protocol have.
void add_keys_of_protocols(const std::string& section, std::vector<RequiredKey>* all) {
  for (const DriveProtocol* protocol : drive_protocols()) {
    for (const ProtocolKey& key : protocol->required) {
      if (section == key.section) all->push_back({key.section, key.key, protocol->word, key.what});
    }
  }
  for (const DriveProtocol* protocol : drive_protocols()) {
    for (const ProtocolKey& key : protocol->required) {
      const auto same = [&](const RequiredKey& row) {
        return row.section == std::string_view(key.section) && row.key == std::string_view(key.key);
      };
      if (std::string_view(key.section).starts_with(section + ".") &&
          std::ranges::none_of(*all, same))
        all->push_back({key.section, key.key, "", key.what});
    }
  }
}

std::vector<RequiredKey> all_keys() {
  std::vector<RequiredKey> all;
  std::string section;
  for (const RequiredKey& row : kOfEveryRobot) {
    if (section != row.section && !section.empty()) add_keys_of_protocols(section, &all);
    section = row.section;
    all.push_back(row);
    if (all.back().key == std::string_view("protocol"))
      all.back().what += fmt::format(": {}", fmt::join(protocol_words(), ", "));
  }
  return all;
}

std::vector<std::string> alternatives(const std::string& key) {
  const auto bar = key.find('|');
  if (bar == std::string::npos) return {key};
  return {key.substr(0, bar), key.substr(bar + 1)};
}

/// What is not readable at all is left to the reader, which complains of it.
void if_readable(const std::function<void()>& part) {
  try {
    part();
  } catch (const ConfigError&) {
  }
}

class Search {
 public:
  explicit Search(const std::string& file) : complaints_(file) {}

  /// Keys of a section; of rows with a condition those whose condition is `only`.
  void check(const YamlMap& map, const std::string& section, const std::string& only = "") {
    for (const RequiredKey& row : required_keys()) {
      if (section != row.section || (!row.only.empty() && only != row.only)) continue;
      const auto keys = alternatives(row.key);
      if (std::ranges::any_of(keys, [&](const std::string& key) { return map.has(key); })) continue;
      complaints_.collect([&] { map.refuse_missing(keys.front(), row.what); });
    }
  }
  /// A mapping below, if it is there.
  void check_below(const YamlMap& map, const std::string& key, const std::string& section) {
    if (map.is_map(key)) check(map.map(key), section);
  }
  void finish() const { complaints_.throw_if_any(); }

 private:
  Complaints complaints_;
};

/// The protocol of each motor.
std::map<std::string, std::string> check_motors(const YamlMap& motors, Search* search) {
  std::map<std::string, std::string> protocols;
  for (const std::string& name : motors.keys()) {
    if (!motors.is_map(name)) continue;
    const YamlMap motor = motors.map(name);
    if (motor.has("protocol"))
      if_readable([&] { protocols[name] = motor.word("protocol", protocol_words()); });
    search->check(motor, "motors.*", protocols[name]);
    for (const std::string& part : motor.keys())
      search->check_below(motor, part, "motors.*." + part);
  }
  return protocols;
}

void check_joints(const YamlMap& joints, const std::map<std::string, std::string>& protocols,
                  Search* search) {
  std::vector<std::string> motors;
  for (const auto& [motor, protocol] : protocols) motors.push_back(motor);
  for (const std::string& name : joints.keys()) {
    if (!joints.is_map(name)) continue;
    const YamlMap joint = joints.map(name);
    std::string protocol;
    if_readable([&] { protocol = protocols.at(joint.word("motor", motors)); });
    search->check(joint, "joints.*", protocol);
    search->check_below(joint, "hold", "joints.*.hold");
  }
}

void check_hand(const YamlMap& hand, Search* search) {
  search->check(hand, "hand");
  for (const char* part : {"travel", "hold"})
    search->check_below(hand, part, std::string("hand.") + part);
}

void check_buses(const YamlMap& yaml, Search* search) {
  for (const YamlMap& bus : yaml.maps("buses")) {
    bool fd = false;
    if_readable([&] { fd = bus.boolean_or("fd", false); });
    search->check(bus, "buses[]", fd ? "fd: true" : "");
  }
}

}  // namespace

const std::vector<RequiredKey>& required_keys() {
  static const std::vector<RequiredKey> all = all_keys();
  return all;
}

void check_required_keys(const YamlMap& yaml) {
  Search search(yaml.file());
  search.check(yaml, "");
  if (yaml.is_list("buses")) if_readable([&] { check_buses(yaml, &search); });
  search.check_below(yaml, "watchdog", "watchdog");
  std::map<std::string, std::string> protocols;
  if (yaml.is_map("motors")) protocols = check_motors(yaml.map("motors"), &search);
  if (yaml.is_map("joints")) check_joints(yaml.map("joints"), protocols, &search);
  if (yaml.is_map("hand")) check_hand(yaml.map("hand"), &search);
  search.check_below(yaml, "gains", "gains");
  search.finish();
}

std::string required_keys_table() {
  std::string table = "| where | key | what it is |\n|---|---|---|\n";
  for (const RequiredKey& row : required_keys()) {
    std::string keys;
    for (const std::string& key : alternatives(row.key))
      keys += fmt::format("{}`{}`", keys.empty() ? "" : " or ", key);
    const std::string where = *row.section == '\0' ? "" : fmt::format("`{}`", row.section);
    const std::string only = row.only.empty() ? "" : fmt::format(" (`{}` only)", row.only);
    table += fmt::format("| {} | {} | {}{} |\n", where, keys, row.what, only);
  }
  return table;
}

}  // namespace limber
