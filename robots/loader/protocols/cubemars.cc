// cubemars: CubeMars and T-Motor AK drives in MIT mode. id 1 to 127.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "robots/loader/protocols/drive_protocol.h"
#include "robots/loader/protocols/mit_range.h"

namespace limber {
namespace {

constexpr int kBoardV1 = 1;
constexpr int kBoardV3 = 3;

/// Ranges of a command, which no drive tells. Another firmware of the same motor may have others.
/// Sources: CubeMars, AK series driver manual 1.0.8; V1: dfki-ric mini-cheetah-tmotor-python-can;
/// V3: clients of manual V3.0.1 (protocol.md of sam0rr/cubemars_servo_can).
struct CubemarsModel {
  std::string_view name;
  int board;
  CommandRange range;
};
constexpr std::array kCubemarsModels = {
    CubemarsModel{"AK10-9", 2, {12.5, 50.0, 65.0, 500.0, 5.0}},
    CubemarsModel{"AK10-9", 3, {12.56, 28.0, 54.0, 500.0, 5.0}},
    CubemarsModel{"AK60-6", 2, {12.5, 50.0, 15.0, 500.0, 5.0}},
    CubemarsModel{"AK60-6", 3, {12.56, 60.0, 12.0, 500.0, 5.0}},
    CubemarsModel{"AK70-10", 2, {12.5, 50.0, 25.0, 500.0, 5.0}},
    CubemarsModel{"AK80-6", 1, {95.5, 45.0, 18.0, 500.0, 5.0}},
    CubemarsModel{"AK80-6", 2, {12.5, 76.0, 12.0, 500.0, 5.0}},
    CubemarsModel{"AK80-64", 2, {12.5, 8.0, 144.0, 500.0, 5.0}},
    CubemarsModel{"AK80-9", 2, {12.5, 50.0, 18.0, 500.0, 5.0}},
};

constexpr ProtocolKey kCubemarsRequired[] = {
    {"motors.*",
     "board",
     "V1 replies in six bytes, V2 in eight; V3 has 29-bit identifiers",
     {.word = "V2"},
     "the plate or the maker's tool; replies of 6 bytes are of V1"},
    {"motors.*",
     "model",
     "AK80-9, ..., or other; it gives the ranges that no drive tells",
     {.word = "AK10-9"},
     "the plate of the drive"},
    {"motors.*.mit_range", "kp_Nm_per_rad", "500 in CubeMars drives", {500}},
    {"motors.*.mit_range", "kd_Nms_per_rad", "5 in CubeMars drives", {5}},
};
constexpr const char* kCubemarsKeys[] = {"board", "model", "mit_range", "pole_pairs", "reply_id"};

CommandRange range_of(const YamlMap& yaml, const std::string& model, int board) {
  if (yaml.has("mit_range")) return read_mit_range(yaml.map("mit_range"));
  for (const CubemarsModel& row : kCubemarsModels) {
    if (row.name == model && row.board == board) return row.range;
  }
  yaml.refuse_missing("mit_range",
                      fmt::format("the ranges of {} with board V{} are not known here; they are in "
                                  "its manual",
                                  model, board));
}

void read_cubemars_motor(const YamlMap& yaml, DriveConfig* drive) {
  std::vector<std::string> models = {"other"};
  for (const CubemarsModel& row : kCubemarsModels) {
    if (models.back() != row.name) models.emplace_back(row.name);
  }
  drive->board = yaml.word("board", {"V1", "V2", "V3"})[1] - '0';
  const std::string model = yaml.word("model", models);
  drive->range = range_of(yaml, model, drive->board);
  drive->counts_per_turn = std::exp2(yaml.integer_or("encoder_bits", 8, 24, 14));
  drive->pole_pairs = static_cast<int>(yaml.integer_or("pole_pairs", 1, 100, drive->pole_pairs));
  if (drive->board == kBoardV1) {
    for (const char* key : {"warning_temperature_degC", "limit_temperature_degC"}) {
      if (yaml.has(key)) yaml.refuse(key, "boards V1 report no temperature");
    }
    drive->warning_temperature_degC = drive->limit_temperature_degC =
        std::numeric_limits<double>::infinity();
  }
  if (!(drive->peak_torque_Nm <= drive->range.torque_Nm))
    yaml.refuse("peak_torque_Nm",
                fmt::format("{} is more than the {} that a command can carry (model {}, board V{})",
                            drive->peak_torque_Nm, drive->range.torque_Nm, model, drive->board));
}

void read_cubemars_ids(const YamlMap& yaml, DriveConfig* drive) {
  const auto id = static_cast<std::uint32_t>(yaml.integer("id", 1, 127));
  const bool v3 = drive->board == kBoardV3;
  if (v3 && yaml.has("reply_id")) yaml.refuse("reply_id", "is not of boards V3");
  drive->command_id = v3 ? 0x800U | id : id;
  drive->reply_id =
      v3 ? 0x2900U | id : static_cast<std::uint32_t>(yaml.integer_or("reply_id", 0, kMostId, 0));
  if (drive->reply_id == drive->command_id) yaml.refuse("reply_id", "must differ from id");
}

FrameSizes cubemars_frames(const JointConfig& joint, bool /*fd*/) {
  return {8, {joint.drive.board == kBoardV1 ? 6 : 8}};
}

std::string cubemars_address(const DriveConfig& drive) {
  return fmt::format("motor {}", drive.command_id & 0xFFU);
}

}  // namespace

extern const DriveProtocol kCubemars;
const DriveProtocol kCubemars = {
    .word = "cubemars",
    .title = "CubeMars",
    .usually_fd = false,
    .rotary_only = true,
    .single_turn = true,
    .shares_reply_id = true,
    .id_found = "motor ID in its maker's tool",
    .usual_gear_ratio = 9.0,
    .joints_a_bus = 3,
    .warning_temperature_degC = 80.0,  // guessed, as of Damiao's windings
    .limit_temperature_degC = 90.0,    // guessed: below the drive's own error
    .required = kCubemarsRequired,
    .keys = kCubemarsKeys,
    .read_motor = read_cubemars_motor,
    .read_ids = read_cubemars_ids,
    .address = cubemars_address,
    .frames = cubemars_frames,
};

}  // namespace limber
