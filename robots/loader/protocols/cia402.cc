// cia402: CANopen drives. Node id 1 to 127; RPDO 1 to the drive is 0x200 + id, TPDOs 1, 2, .. from
// it 0x180 + id, 0x280 + id, ..
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

constexpr ProtocolKey kCia402Required[] = {
    {"motors.*",
     "encoder_bits|counts_per_turn",
     "encoder counts per turn of the joint",
     {20},
     "object 608Fh times the gear 6091h, per turn of the joint"},
    {"motors.*",
     "rated_torque_Nm",
     "object 6076h, at the joint",
     {0.0, Figure::kPeakTorque, 1.0 / 30.0},
     "object 6076h, at the joint"},
};
constexpr const char* kCia402Keys[] = {"rated_torque_Nm", "counts_per_turn"};
constexpr int kLeastBits = 8;
constexpr int kMostBits = 28;
constexpr std::uint32_t kRpdo1 = 0x200;
constexpr std::uint32_t kTpdo1 = 0x180;
constexpr std::uint32_t kPdoStep = 0x100;
constexpr std::uint32_t kSdoRequest = 0x600;
constexpr std::uint32_t kSdoAnswer = 0x580;

/// Any number per turn of the joint: behind a gear not even a whole one.
double read_counts(const YamlMap& yaml) {
  if (!yaml.has("counts_per_turn"))
    return std::exp2(yaml.integer("encoder_bits", kLeastBits, kMostBits));
  if (yaml.has("encoder_bits"))
    yaml.refuse("encoder_bits", "counts_per_turn says it already: one of them");
  return yaml.number("counts_per_turn", {std::exp2(kLeastBits), std::exp2(kMostBits)});
}

/// Torques are 16-bit thousandths of the rated torque; the driver makes stiffness and damping.
void read_cia402_motor(const YamlMap& yaml, DriveConfig* drive) {
  constexpr double kMost = 32.767;  // times the rated torque
  constexpr double kNoEnd = std::numeric_limits<double>::infinity();
  drive->rated_torque_Nm = yaml.number("rated_torque_Nm", {0.001, 1e4});
  drive->range = {kNoEnd, kNoEnd, kMost * drive->rated_torque_Nm, kNoEnd, kNoEnd};
  if (!(drive->peak_torque_Nm <= drive->range.torque_Nm)) {
    yaml.refuse("rated_torque_Nm",
                fmt::format("{} cannot carry the peak torque of {}: 32767 thousandths are {:.4g}",
                            drive->rated_torque_Nm, drive->peak_torque_Nm, drive->range.torque_Nm));
  }
  drive->counts_per_turn = read_counts(yaml);
}

void read_cia402_ids(const YamlMap& yaml, DriveConfig* drive) {
  const auto node = static_cast<std::uint32_t>(yaml.integer("id", 1, 127));
  drive->command_id = kRpdo1 + node;
  drive->reply_id = kTpdo1 + node;
}

/// The node's identifiers of the predefined connection set (CiA 301): network management, SYNC, and
/// those that end in the node number: emergency, four PDOs each way, service data, heartbeat.
bool reserves_id(const DriveConfig& drive, std::uint32_t id) {
  constexpr std::uint32_t kNode = 0x7F;
  constexpr std::uint32_t kTime = 0x100;
  if (id == 0x000 || id == 0x080) return true;
  const std::uint32_t code = id & ~kNode;
  return (id & kNode) == drive.command_id - kRpdo1 && code >= 0x080 && code != kTime &&
         code <= 0x700 && code != 0x680;
}

/// CAN-FD: all in one. Classic: status and position, velocity and torque, the link's angle and
/// speed; the current has room beside the torque and is wanted where that is a sensor's.
FrameSizes cia402_frames(const JointConfig& joint, bool fd) {
  const bool link = joint.link_encoder.present;
  if (fd) return {4, {link ? 24 : 16}};
  FrameSizes sizes{4, {6, joint.torque_sensor.present ? 8 : 6}, kPdoStep};
  if (link) sizes.replies.push_back(8);
  return sizes;
}

std::string node_address(const DriveConfig& drive) {
  return fmt::format("node {}", drive.command_id - kRpdo1);
}

SettingFrames sdo_frames(const DriveConfig& drive) {
  const std::uint32_t node = drive.command_id - kRpdo1;
  return {kSdoRequest + node, kSdoAnswer + node, true};
}

}  // namespace

extern const DriveProtocol kCia402;
const DriveProtocol kCia402 = {
    .word = "cia402",
    .title = "CiA 402",
    .enabling_s = 2.0,  // some open a brake first
    .usually_fd = false,
    .reports_link = true,
    .needs_sync = true,
    .rotary_only = true,
    .usual_gear_ratio = 100.0,
    .joints_a_bus = 2,
    .required = kCia402Required,
    .keys = kCia402Keys,
    .read_motor = read_cia402_motor,
    .read_ids = read_cia402_ids,
    .address = node_address,
    .frames = cia402_frames,
    .setting = sdo_frames,
    .reserves_id = reserves_id,
};

}  // namespace limber
