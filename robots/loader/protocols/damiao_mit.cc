// damiao_mit: Damiao drives in MIT mode. id 1 to 15 and reply_id, as they are on the bus.
#include <fmt/format.h>

#include <cmath>

#include "robots/loader/protocols/drive_protocol.h"
#include "robots/loader/protocols/mit_range.h"

namespace limber {
namespace {

constexpr const char* kRange = "motors.*.mit_range";
constexpr ProtocolKey kDamiaoRequired[] = {
    {"motors.*", "encoder_bits", "encoder counts per turn of the joint, as bits", {14}},
    {"motors.*",
     "mit_range",
     "ranges stored in the drive",
     {},
     "PMAX, VMAX and TMAX as the maker's tool shows them; the driver compares them"},
    {kRange, "position_rad", "PMAX of the drive", {12.5}},
    {kRange, "velocity_rad_per_s", "VMAX of the drive", {1.0, Figure::kSpeed, 1.5}},
    {kRange, "torque_Nm", "TMAX of the drive", {0.0, Figure::kPeakTorque, 1.1}},
    {kRange, "kp_Nm_per_rad", "500 in Damiao drives", {500}},
    {kRange, "kd_Nms_per_rad", "5 in Damiao drives", {5}},
    {"joints.*",
     "reply_id",
     "identifier of the drive's replies (MST_ID)",
     {0x10},
     "MST_ID of the drive"},
};
constexpr const char* kDamiaoKeys[] = {"mit_range", "reply_id"};

void read_damiao_mit_motor(const YamlMap& yaml, DriveConfig* drive) {
  drive->range = read_mit_range(yaml.map("mit_range"));
  drive->counts_per_turn = std::exp2(yaml.integer("encoder_bits", 8, 24));
  if (!(drive->peak_torque_Nm <= drive->range.torque_Nm)) {
    const bool exchanged = drive->peak_torque_Nm <= drive->range.velocity_rad_per_s;
    yaml.refuse("peak_torque_Nm",
                fmt::format("{} is more than the {} the torque field can carry (mit_range){}",
                            drive->peak_torque_Nm, drive->range.torque_Nm,
                            exchanged ? "; are velocity_rad_per_s and torque_Nm exchanged?" : ""));
  }
}

void read_damiao_mit_ids(const YamlMap& yaml, DriveConfig* drive) {
  // The reply carries the identifier in four bits. 0x7FF is the register identifier.
  drive->command_id = static_cast<std::uint32_t>(yaml.integer("id", 1, 15));
  drive->reply_id = static_cast<std::uint32_t>(yaml.integer("reply_id", 1, kMostId));
  if (drive->reply_id == drive->command_id) yaml.refuse("reply_id", "must differ from id");
}

FrameSizes damiao_mit_frames(const JointConfig& /*joint*/, bool /*fd*/) { return {8, {8}}; }

std::string damiao_address(const DriveConfig& drive) {
  return fmt::format("id 0x{:X}", drive.command_id);
}

/// Registers are read and written under an identifier that all drives share.
SettingFrames damiao_setting(const DriveConfig& drive) { return {0x7FF, drive.reply_id, false}; }

}  // namespace

extern const DriveProtocol kDamiaoMit;
const DriveProtocol kDamiaoMit = {
    .word = "damiao_mit",
    .title = "Damiao",
    .single_turn = true,
    .hex_ids = true,
    .id_found = "CAN_ID of the drive",
    .usual_gear_ratio = 10.0,
    .joints_a_bus = 7,
    .warning_temperature_degC = 80.0,  // guessed: 20 K below the 100 of its makers' windings
    .limit_temperature_degC = 90.0,    // guessed: half way there, while the drive still holds
    .required = kDamiaoRequired,
    .keys = kDamiaoKeys,
    .read_motor = read_damiao_mit_motor,
    .read_ids = read_damiao_mit_ids,
    .address = damiao_address,
    .frames = damiao_mit_frames,
    .setting = damiao_setting,
};

}  // namespace limber
