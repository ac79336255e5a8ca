// moteus: id 1 to 126. On the bus the command is 0x8000 | id, from host 0 with an answer wanted,
// and the answer id << 8.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

/// A share of the drive's own gains is commanded: a little more than holding needs, per turn.
constexpr double kFirstGain = 2.0 * std::numbers::pi * 1.01;
constexpr const char* kGains = "motors.*.pid_position";
constexpr ProtocolKey kMoteusRequired[] = {
    {"motors.*", "encoder_bits", "encoder counts per turn of the joint, as bits", {14}},
    {"motors.*",
     "pid_position",
     "gains configured in the drive",
     {},
     "servo.pid_position.kp and .kd as moteus_tool reads them"},
    {kGains,
     "kp_Nm_per_turn",
     "servo.pid_position.kp of the drive",
     {0.0, Figure::kHoldKp, kFirstGain}},
    {kGains,
     "kd_Nms_per_turn",
     "servo.pid_position.kd of the drive",
     {0.0, Figure::kHoldKd, kFirstGain}},
};
constexpr const char* kMoteusKeys[] = {"pid_position", "timeout_torque_Nm"};
constexpr std::uint32_t kNodeBits = 0x7F;
constexpr std::uint32_t kBroadcast = 0x7F;

/// Floats carry everything; kp and kd go as a share of what is configured in the drive, and are
/// brought from turns to rad.
void read_moteus_motor(const YamlMap& yaml, DriveConfig* drive) {
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  constexpr double kNoEnd = std::numeric_limits<double>::infinity();
  const YamlMap gains = yaml.map("pid_position");
  drive->range = {kNoEnd, kNoEnd, kNoEnd, gains.number("kp_Nm_per_turn", {1e-3, 1e5}) / kTurn_rad,
                  gains.number("kd_Nms_per_turn", {1e-3, 1e4}) / kTurn_rad};
  gains.finish();
  drive->timeout_torque_Nm =
      yaml.number_or("timeout_torque_Nm", {0.0, drive->peak_torque_Nm},
                     std::min(drive->timeout_torque_Nm, drive->peak_torque_Nm));
  drive->counts_per_turn = std::exp2(yaml.integer("encoder_bits", 8, 32));
}

void read_moteus_ids(const YamlMap& yaml, DriveConfig* drive) {
  const auto id = static_cast<std::uint32_t>(yaml.integer("id", 1, 126));
  drive->command_id = 0x8000U | id;
  drive->reply_id = id << 8U;
}

/// A frame is for the node whose number its identifier ends in.
bool accepts(const DriveConfig& drive, std::uint32_t id) {
  const std::uint32_t node = id & kNodeBits;
  return node == (drive.command_id & kNodeBits) || node == kBroadcast;
}

std::string servo_address(const DriveConfig& drive) {
  return fmt::format("servo {}", drive.command_id & kNodeBits);
}

FrameSizes moteus_frames(const JointConfig& /*joint*/, bool /*fd*/) { return {48, {32}}; }

}  // namespace

extern const DriveProtocol kMoteus;
const DriveProtocol kMoteus = {
    .word = "moteus",
    .title = "moteus",
    .needs_fd = true,
    .rotary_only = true,
    .sample_point = 0.666,  // mjbots, moteus reference
    .usual_gear_ratio = 9.0,
    .joints_a_bus = 3,
    .warning_temperature_degC =
        50.0,  // its firmware reduces the current from there on, and faults at 75
    .limit_temperature_degC = 65.0,  // guessed: there 40 % of its current are left
    .required = kMoteusRequired,
    .keys = kMoteusKeys,
    .read_motor = read_moteus_motor,
    .read_ids = read_moteus_ids,
    .address = servo_address,
    .frames = moteus_frames,
    .accepts_id = accepts,
};

}  // namespace limber
