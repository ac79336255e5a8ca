// robstride: RobStride drives (and the CyberGear) in their private protocol. id 1 to 127.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

/// What a count of the fields means: no register tells it. Source: manuals of 2026-04.
struct Model {
  const char* word;
  CommandRange range;
};
constexpr double kTwoTurns = 4.0 * std::numbers::pi;
constexpr std::array kModels = {
    Model{"RS00", {kTwoTurns, 33.0, 14.0, 500.0, 5.0}},
    Model{"RS01", {kTwoTurns, 44.0, 17.0, 500.0, 5.0}},
    Model{"RS02", {kTwoTurns, 44.0, 17.0, 500.0, 5.0}},
    Model{"RS03", {kTwoTurns, 20.0, 60.0, 5000.0, 100.0}},
    Model{"RS04", {kTwoTurns, 15.0, 120.0, 5000.0, 100.0}},
    Model{"RS05", {kTwoTurns, 50.0, 5.5, 500.0, 5.0}},
    Model{"RS06", {kTwoTurns, 50.0, 36.0, 5000.0, 100.0}},
    Model{"EL05", {kTwoTurns, 50.0, 6.0, 500.0, 5.0}},
    Model{"CyberGear", {kTwoTurns, 30.0, 12.0, 500.0, 5.0}},
};

constexpr ProtocolKey kRequired[] = {
    {"motors.*",
     "model",
     "RS00 to RS06, EL05 or CyberGear: the drive does not report its ranges",
     {.word = "RS04"},
     "the plate of the drive"},
};
constexpr const char* kKeys[] = {"model", "firmware_range"};

void read_motor(const YamlMap& yaml, DriveConfig* drive) {
  std::vector<std::string> words;
  for (const Model& model : kModels) words.emplace_back(model.word);
  const std::string word = yaml.word("model", words);
  drive->range =
      std::ranges::find_if(kModels, [&](const Model& model) { return word == model.word; })->range;
  if (yaml.has("firmware_range")) {  // of firmware that differs from the manual
    const YamlMap own = yaml.map("firmware_range");
    drive->range.velocity_rad_per_s =
        own.number_or("velocity_rad_per_s", {0.1, 1000.0}, drive->range.velocity_rad_per_s);
    drive->range.torque_Nm = own.number_or("torque_Nm", {0.01, 1000.0}, drive->range.torque_Nm);
    own.finish();
  }
  drive->counts_per_turn = std::exp2(yaml.integer_or("encoder_bits", 8, 24, 14));
  if (!(drive->peak_torque_Nm <= drive->range.torque_Nm)) {
    yaml.refuse("peak_torque_Nm", fmt::format("{} is more than the {} that a command to model {} "
                                              "can carry",
                                              drive->peak_torque_Nm, drive->range.torque_Nm, word));
  }
}

constexpr std::uint32_t kControl = 1U << 24U;
constexpr std::uint32_t kState = 2U << 24U;
constexpr std::uint32_t kRead = 17U << 24U;
constexpr std::uint32_t kReport = 24U << 24U;
constexpr std::uint32_t kHost = 0xFD;

/// The identifiers of a command without torque, and of a state without flags: further bits of both
/// are data.
void read_ids(const YamlMap& yaml, DriveConfig* drive) {
  const auto id = static_cast<std::uint32_t>(yaml.integer("id", 1, 127));
  drive->command_id = kControl | id;
  drive->reply_id = kState | id << 8U | kHost;
}

SettingFrames setting(const DriveConfig& drive) {
  const std::uint32_t id = drive.command_id & 0x7FU;
  return {kRead | kHost << 8U | id, kRead | id << 8U | kHost, true};
}

/// A control frame has its torque in the identifier, a state its mode and faults.
std::uint32_t kind(std::uint32_t id) {
  const std::uint32_t type = id & 0x1F000000U;
  if (type == kControl) return id & 0x1F0000FFU;
  return type == kState || type == kReport ? id & 0x1F00FFFFU : id;
}

std::string address(const DriveConfig& drive) {
  return fmt::format("motor {}", drive.command_id & 0x7FU);
}

FrameSizes frames(const JointConfig& /*joint*/, bool /*fd*/) { return {8, {8}}; }

}  // namespace

extern const DriveProtocol kRobstride;
const DriveProtocol kRobstride = {
    .word = "robstride",
    .title = "RobStride",
    .usually_fd = false,
    .rotary_only = true,
    .single_turn = true,
    .id_found = "CAN_ID of the motor (parameter 200A, or its maker's tool)",
    .usual_gear_ratio = 10.0,
    .joints_a_bus = 2,
    .warning_temperature_degC = 80.0,  // guessed, as of Damiao's windings
    .limit_temperature_degC = 90.0,    // guessed: below the over-temperature fault of the makers
    .required = kRequired,
    .keys = kKeys,
    .read_motor = read_motor,
    .read_ids = read_ids,
    .address = address,
    .frames = frames,
    .setting = setting,
    .kind = kind,
};

}  // namespace limber
