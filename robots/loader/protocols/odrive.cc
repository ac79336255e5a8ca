// odrive: ODrive S1, Pro and Micro in the protocol CANSimple, firmware 0.6. id 1 to 62.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "robots/loader/protocols/drive_protocol.h"
#include "robots/loader/protocols/odrive_endpoints.h"

namespace limber {
namespace {

constexpr ProtocolKey kOdriveRequired[] = {
    {"motors.*",
     "firmware",
     "0.6.11, or another 0.6 with its `endpoints`; the driver compares it",
     {.word = "0.6.11"},
     "`limber motors show`"},
};
constexpr const char* kOdriveKeys[] = {"firmware", "endpoints"};

/// Torque alone is commanded; the driver makes stiffness and damping.
void read_odrive_motor(const YamlMap& yaml, DriveConfig* drive) {
  constexpr double kNoEnd = std::numeric_limits<double>::infinity();
  const std::string text = yaml.text("firmware");
  int revision = 0;
  int end = 0;
  if (std::sscanf(text.c_str(), "0.6.%3d%n", &revision, &end) != 1 || revision < 0 ||
      revision > 255 || end != static_cast<int>(text.size()))
    yaml.refuse("firmware", fmt::format("{} is none of 0.6, such as 0.6.11", text));
  drive->firmware = 0x0600U | static_cast<std::uint32_t>(revision);
  drive->endpoints = odrive_endpoints(revision);
  if (yaml.has("endpoints")) {
    const YamlMap own = yaml.map("endpoints");
    for (std::size_t i = 0; i < kOdriveEndpoints.size(); ++i)
      drive->endpoints[i] =
          static_cast<std::uint16_t>(own.integer(kOdriveEndpoints[i].name, 1, 0xFFFF));
    own.finish();
  } else if (drive->endpoints[0] == 0) {
    yaml.refuse_missing("endpoints", "the numbers of firmware " + text +
                                         " are in its flat_endpoints.json, from its maker");
  }
  drive->range = {kNoEnd, kNoEnd, kNoEnd, kNoEnd, kNoEnd};
  drive->counts_per_turn =
      drive->gear_ratio * std::exp2(yaml.integer_or("encoder_bits", 8, 24, 14));
}

constexpr std::uint32_t kOdriveEstimates = 0x09;
constexpr std::uint32_t kOdriveError = 0x03;
constexpr std::uint32_t kOdriveTorque = 0x0E;
constexpr std::uint32_t kOdriveTorques = 0x1C;
constexpr std::uint32_t kOdriveEveryNode = 63;

std::uint32_t odrive_first_id(const DriveConfig& drive) { return drive.command_id & ~0x1FU; }

void read_odrive_ids(const YamlMap& yaml, DriveConfig* drive) {
  const auto node = static_cast<std::uint32_t>(yaml.integer("id", 1, 62));
  drive->command_id = node << 5U | kOdriveTorque;
  drive->reply_id = node << 5U | kOdriveEstimates;
}

bool reserves_odrive_id(const DriveConfig& drive, std::uint32_t id) {
  return id <= 0x7FF && (id & ~0x1FU) == odrive_first_id(drive);
}
bool accepts_odrive_id(const DriveConfig& /*drive*/, std::uint32_t id) {
  return id <= 0x7FF && id >> 5U == kOdriveEveryNode;
}

std::string odrive_address(const DriveConfig& drive) {
  return fmt::format("node {}", drive.command_id >> 5U);
}

SettingFrames odrive_setting(const DriveConfig& drive) {
  return {odrive_first_id(drive) | 4U, odrive_first_id(drive) | 5U, true};
}

FrameSizes odrive_frames(const JointConfig& joint, bool /*fd*/) {
  const std::uint32_t first = odrive_first_id(joint.drive);
  return {
      4, {8, 8, 8}, 0, {first | kOdriveEstimates, first | kOdriveError, first | kOdriveTorques}};
}

}  // namespace

/// Source: the maker's flat_endpoints.json of 0.6.11-1.
std::array<std::uint16_t, kOdriveEndpoints.size()> odrive_endpoints(int revision) noexcept {
  if (revision != 11) return {};
  return {223, 243, 244, 275, 378, 379, 384};
}

extern const DriveProtocol kOdrive;
const DriveProtocol kOdrive = {
    .word = "odrive",
    .title = "ODrive",
    .enabling_s = 0.5,  // told by the heartbeat, every 0.1 s
    .usually_fd = false,
    .rotary_only = true,
    .id_found = "node_id of the axis, 1 to 62",
    .usual_gear_ratio = 8.0,
    .joints_a_bus = 1,
    .required = kOdriveRequired,
    .keys = kOdriveKeys,
    .read_motor = read_odrive_motor,
    .read_ids = read_odrive_ids,
    .address = odrive_address,
    .frames = odrive_frames,
    .setting = odrive_setting,
    .reserves_id = reserves_odrive_id,
    .accepts_id = accepts_odrive_id,
};

}  // namespace limber
