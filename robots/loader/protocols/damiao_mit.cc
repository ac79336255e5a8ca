// damiao_mit: Damiao drives in MIT mode. id 1 to 15 and reply_id, as they are on the bus.
#include <fmt/format.h>

#include <cmath>

#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

constexpr const char* kDamiaoKeys[] = {"mit_range", "reply_id"};

CommandRange read_range(const YamlMap& yaml) {
  CommandRange range;
  range.position_rad = yaml.number("position_rad", {1.0, 200.0});
  range.velocity_rad_per_s = yaml.number("velocity_rad_per_s", {0.1, 1000.0});
  range.torque_Nm = yaml.number("torque_Nm", {0.01, 5e4});
  range.kp_Nm_per_rad = yaml.number("kp_Nm_per_rad", {1.0, 5000.0});
  range.kd_Nms_per_rad = yaml.number("kd_Nms_per_rad", {0.01, 500.0});
  yaml.finish();
  return range;
}

void read_damiao_mit_motor(const YamlMap& yaml, DriveConfig* drive) {
  drive->range = read_range(yaml.map("mit_range"));
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
  drive->reply_id = static_cast<std::uint32_t>(yaml.integer("reply_id", 1, 0x7FE));
  if (drive->reply_id == drive->command_id) yaml.refuse("reply_id", "must differ from id");
}

FrameSizes damiao_mit_frames(const JointConfig& /*joint*/, bool /*fd*/) { return {8, {8}}; }

std::string damiao_address(const DriveConfig& drive) {
  return fmt::format("id 0x{:X}", drive.command_id);
}

}  // namespace

const DriveProtocolTraits kDamiaoMitTraits = {
    .protocol = DriveProtocol::kDamiaoMit,
    .word = "damiao_mit",
    .warning_temperature_degC = 80.0,  // guessed: 20 K below the 100 of its makers' windings
    .limit_temperature_degC = 90.0,    // guessed: half way there, while the drive still holds
    .keys = kDamiaoKeys,
    .read_motor = read_damiao_mit_motor,
    .read_ids = read_damiao_mit_ids,
    .address = damiao_address,
    .frames = damiao_mit_frames,
};

}  // namespace limber
