// myactuator: MyActuator's RMD-X drives in motion mode. id 1 to 32.
#include <fmt/format.h>

#include <cmath>

#include "robots/loader/protocols/drive_protocol.h"
#include "robots/loader/protocols/myactuator_series.h"

namespace limber {
namespace {

// No order tells the ranges: the firmware has them. Source: drivers/protocols/myactuator.h.
constexpr CommandRange kBefore = {12.5, 45.0, 24.0, 500.0, 5.0};
constexpr CommandRange kFromV44 = {12.566, 45.0, 0.0, 500.0, 50.0};  // torque: the model's most
constexpr ProtocolKey kMyactuatorRequired[] = {
    {"motors.*",
     "firmware",
     "V4.2 before version date 2026042402, V4.4 from it on; the driver compares it",
     {.word = "V4.4"},
     "`limber motors show`"},
    {"motors.*",
     "model",
     "X6, X8, or other: from V4.4 on the driver compares it",
     {.word = "X8"},
     "the plate of the drive"},
};
constexpr const char* kMyactuatorKeys[] = {"firmware", "model", "firmware_range"};

void read_myactuator_motor(const YamlMap& yaml, DriveConfig* drive) {
  std::vector<std::string> words = {"other"};
  for (const MyactuatorSeries& series : kMyactuatorSeries)
    words.push_back(fmt::format("X{}", series.number));
  const std::string word = yaml.word("model", words);
  drive->range = kBefore;
  if (yaml.word("firmware", {"V4.2", "V4.4"}) == "V4.4") {
    drive->range = kFromV44;
    for (const MyactuatorSeries& series : kMyactuatorSeries) {
      if (word == fmt::format("X{}", series.number)) drive->range.torque_Nm = series.most_Nm;
    }
    if (word == "other") {
      const YamlMap own = yaml.map("firmware_range");
      drive->range.torque_Nm = own.number("torque_Nm", {0.01, 1000.0});
      own.finish();
    }
  }
  drive->counts_per_turn = std::exp2(yaml.integer_or("encoder_bits", 8, 24, 17));
  if (!(drive->peak_torque_Nm <= drive->range.torque_Nm)) {
    yaml.refuse("peak_torque_Nm", fmt::format("{} is more than the {} that a command can carry "
                                              "(model {}, this firmware)",
                                              drive->peak_torque_Nm, drive->range.torque_Nm, word));
  }
}

constexpr std::uint32_t kOrder = 0x140;
constexpr std::uint32_t kAnswer = 0x240;
constexpr std::uint32_t kMotion = 0x400;
constexpr std::uint32_t kMotionAnswer = 0x500;

std::uint32_t number_of(const DriveConfig& drive) { return drive.command_id - kMotion; }

void read_myactuator_ids(const YamlMap& yaml, DriveConfig* drive) {
  const auto id = static_cast<std::uint32_t>(yaml.integer("id", 1, 32));
  drive->command_id = kMotion + id;
  drive->reply_id = kMotionAnswer + id;
}

bool reserves(const DriveConfig& drive, std::uint32_t id) {
  return id == kOrder + number_of(drive) || id == kAnswer + number_of(drive);
}

/// Orders to all motors, and the number for all; and what starts the update of the firmware.
bool myactuator_accepts(const DriveConfig& drive, std::uint32_t id) {
  return id == 0x280 || id == 0x300 || id == ((number_of(drive) & 0x1FU) << 6U | 0x28U);
}

std::string myactuator_address(const DriveConfig& drive) {
  return fmt::format("motor {}", number_of(drive));
}

SettingFrames myactuator_setting(const DriveConfig& drive) {
  return {kOrder + number_of(drive), kAnswer + number_of(drive), true};
}

FrameSizes myactuator_frames(const JointConfig& /*joint*/, bool /*fd*/) { return {8, {8}}; }

}  // namespace

extern const DriveProtocol kMyactuator;
const DriveProtocol kMyactuator = {
    .word = "myactuator",
    .title = "MyActuator",
    .enabling_s = 0.5,  // a brake takes 50 to 150 ms: github.com/almond-bot/axol, pull request 45
    .usually_fd = false,
    .rotary_only = true,
    .single_turn = true,
    .id_found = "number of the motor (CAN ID in its maker's tool)",
    .usual_gear_ratio = 20.0,
    .joints_a_bus = 3,
    .warning_temperature_degC = 80.0,  // guessed, as of Damiao's windings
    .limit_temperature_degC = 90.0,    // guessed: below the drive's own error
    .required = kMyactuatorRequired,
    .keys = kMyactuatorKeys,
    .read_motor = read_myactuator_motor,
    .read_ids = read_myactuator_ids,
    .address = myactuator_address,
    .frames = myactuator_frames,
    .setting = myactuator_setting,
    .reserves_id = reserves,
    .accepts_id = myactuator_accepts,
};

}  // namespace limber
