// The `tip_sensor:` section: what a good one means, and one slip in it each.
#include <cmath>

#include "tests/robots/arm_folder.h"

namespace limber::test_tip_sensor_yaml {
namespace {

using testing::Mutation;

const std::string& kData = testing::kArmData;

std::string good_yaml() { return testing::arm_yaml_with("tip_sensor.yaml"); }

using Folder = testing::ArmFolder;

TEST(TipSensorYaml, Absent) { EXPECT_FALSE(load_robot(kData + "arm/").robot.has_tip_sensor); }

TEST(TipSensorYaml, Complete) {
  const Folder good(good_yaml());
  const Robot robot = load_robot(good.folder.path()).robot;
  ASSERT_TRUE(robot.has_tip_sensor);
  const TipSensorConfig& sensor = robot.tip_sensor;
  EXPECT_EQ(sensor.model, "FT-1");
  EXPECT_EQ(sensor.protocol, TipSensorProtocol::kRobotousRft);
  EXPECT_EQ(sensor.bus, 1);
  EXPECT_EQ(sensor.command_id, 100U);
  EXPECT_EQ(sensor.reply_ids, (std::array<std::uint32_t, 2>{5, 6}));
  EXPECT_EQ(sensor.counts_per_N, 40.0);
  EXPECT_EQ(sensor.counts_per_Nm, 1000.0);
  EXPECT_EQ(sensor.p_TS[2], 0.05);
  // A quarter turn about z.
  EXPECT_NEAR(sensor.quat_TS[0], std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(sensor.quat_TS[1], 0.0, 1e-12);
  EXPECT_NEAR(sensor.quat_TS[2], 0.0, 1e-12);
  EXPECT_NEAR(sensor.quat_TS[3], std::sqrt(0.5), 1e-12);
  EXPECT_EQ(sensor.range, (SixAxes{200, 200, 300, 10, 10, 10}));
  EXPECT_EQ(sensor.resolution, (SixAxes{0.2, 0.2, 0.2, 0.008, 0.008, 0.008}));
  EXPECT_EQ(sensor.noise, (SixAxes{0.1, 0.1, 0.1, 0.004, 0.004, 0.004}));
  EXPECT_EQ(sensor.noise_seed, 7U);
  EXPECT_EQ(sensor.bias, (SixAxes{1, -2, 3, 0, 0, 0}));
  EXPECT_EQ(sensor.filter_time_constant_s, 0.002);
  EXPECT_EQ(sensor.tool_mass_kg, 0.2);
  EXPECT_EQ(sensor.p_SC[2], 0.04);
}

TEST(TipSensorYaml, LimberFtOnTheFdBusWithAQuaternion) {
  std::string yaml = good_yaml();
  for (const Mutation& change :
       {Mutation{"", "protocol: robotous_rft\n  bus: right", "protocol: limber_ft\n  bus: left",
                 ""},
        Mutation{"", "reply_ids: [5, 6]\n  counts_per_N: 40\n  counts_per_Nm: 1000", "reply_id: 5",
                 ""},
        Mutation{"", "rpy_rad: [0, 0, 1.5707963267948966]", "quaternion_wxyz: [0, 0, 1, 0]", ""}}) {
    yaml = testing::apply(yaml, change).text;
  }
  const Folder good(yaml);
  const TipSensorConfig sensor = load_robot(good.folder.path()).robot.tip_sensor;
  EXPECT_EQ(sensor.protocol, TipSensorProtocol::kLimberFt);
  EXPECT_EQ(sensor.replies(), 1);
  EXPECT_EQ(sensor.reply_ids[0], 5U);
  EXPECT_EQ(sensor.quat_TS[2], 1.0);
}

class TipSensorRefusal : public ::testing::TestWithParam<Mutation> {};

TEST_P(TipSensorRefusal, NamesPlaceAndProblem) { testing::expect_refused(good_yaml(), GetParam()); }

const Mutation kSlips[] = {
    {"UnknownKey", "  model: FT-1", "  model: FT-1\n  speed: 3", "unknown key 'speed'", 1},
    {"ModelMissing", "  model: FT-1\n", "", "tip_sensor: 'model' is missing", testing::kNoLine},
    {"Protocol", "robotous_rft", "ethercat", "expected one of: robotous_rft, limber_ft"},
    {"Bus", "bus: right\n  id: 100", "bus: middle\n  id: 100", "expected one of: left, right"},
    {"RftOnAnFdBus", "bus: right\n  id: 100", "bus: left\n  id: 100", "expected a classic bus"},
    {"FtOnAClassicBus", "protocol: robotous_rft", "protocol: limber_ft",
     "'right' is a classic bus; limber_ft needs fd: true", 1},
    {"IdZero", "id: 100", "id: 0", "from 1 to 2046"},
    {"IdTaken", "id: 100", "id: 17", "17 is taken by roll on the same bus"},
    {"ReplyTaken", "[5, 6]", "[5, 1]", "1 is taken by roll on the same bus"},
    {"ReplyIsTheRequest", "[5, 6]", "[100, 6]", "must differ from id"},
    {"RepliesAlike", "[5, 6]", "[5, 5]", "must differ"},
    {"ReplyWithFraction", "[5, 6]", "[5, 6.5]", "expected two whole numbers"},
    {"OneReply", "[5, 6]", "[5]", "found 1 entries; expected a list of 2 numbers"},
    {"PoseMissing", "  pose:", "  posture:", "'pose' is missing", testing::kNoLine},
    {"NoRotation", ", rpy_rad: [0, 0, 1.5707963267948966]", "",
     "either 'rpy_rad' or 'quaternion_wxyz'"},
    {"TwoRotations", "rpy_rad:", "quaternion_wxyz: [1, 0, 0, 0], rpy_rad:",
     "either 'rpy_rad' or 'quaternion_wxyz'"},
    {"QuaternionLength", "rpy_rad: [0, 0, 1.5707963267948966]", "quaternion_wxyz: [1, 0, 0, 0.1]",
     "has length 1.0050; expected 1"},
    {"PoseFar", "[0.01, 0, 0.05]", "[10, 0, 0.05]", "from -1 to 1"},
    {"RangeZero", "torque_Nm: 10", "torque_Nm: 0", "'0' is out of range"},
    {"RangeNotANumber", "torque_Nm: 10", "torque_Nm: .nan", "'.nan' is not a number"},
    {"RangeBeyondSixteenBits", "[200, 200, 300]", "[200, 200, 900]",
     "900 is more than the 819.2 that 16 bits can carry"},
    {"NoiseNegative", "force_N: 0.1,", "force_N: -0.1,", "'-0.1' is out of range"},
    {"FilterNegative", "constant_s: 0.002", "constant_s: -1", "out of range"},
    {"ToolNegative", "mass_kg: 0.2", "mass_kg: -0.2", "out of range"},
    {"ToolHeavierThanTheLink", "mass_kg: 0.2", "mass_kg: 50",
     "kg that the last joint carries; the tool must be part of the URDF"},
};
INSTANTIATE_TEST_SUITE_P(Slips, TipSensorRefusal, ::testing::ValuesIn(kSlips),
                         testing::MutationName());

// moteus nodes 3 and 12 on the bus: 0x103 and 0x18C end in them, 0x27F in everybody's number.
class MoteusSensorRefusal : public ::testing::TestWithParam<Mutation> {};

std::string beside_moteus() {
  const std::string drives = testing::read_text(kData + "moteus/robot.yaml");
  return testing::apply(drives, {"", "../arm/robot.urdf", kData + "arm/robot.urdf", ""}).text +
         "tip_sensor:\n  model: FT-2\n  protocol: limber_ft\n  bus: left\n  id: 100\n"
         "  reply_id: 101\n  pose: {position_m: [0, 0, 0], rpy_rad: [0, 0, 0]}\n"
         "  range: {force_N: 100, torque_Nm: 10}\n";
}

TEST(TipSensorYaml, LivesBesideMoteusDrives) {
  const Folder good(beside_moteus());
  EXPECT_EQ(load_robot(good.folder.path()).robot.tip_sensor.reply_ids[0], 101U);
}

TEST_P(MoteusSensorRefusal, NamesTheDriveThatListens) {
  testing::expect_refused(beside_moteus(), GetParam());
}

const Mutation kListeners[] = {
    {"Request", "id: 100", "id: 259", "259 would reach turn on the same bus"},
    {"Reply", "reply_id: 101", "reply_id: 396", "396 would reach roll on the same bus"},
    {"Everybody", "id: 100", "id: 639", "639 would reach turn on the same bus"},
};
INSTANTIATE_TEST_SUITE_P(Moteus, MoteusSensorRefusal, ::testing::ValuesIn(kListeners),
                         testing::MutationName());

}  // namespace
}  // namespace limber::test_tip_sensor_yaml
