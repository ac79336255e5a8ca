// The stages of a joint in robot.yaml: what a good file means, one slip each, and plant on top.
#include <cmath>

#include "robots/loader/load_robot.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"

namespace limber::test_joint_chain_yaml {
namespace {

using testing::Mutation;

const std::string kData = source_path("tests/robots/data/");

std::string good_yaml() {
  const std::string yaml = testing::read_text(kData + "chain/robot.yaml");
  return testing::apply(yaml, {"", "../arm/robot.urdf", kData + "arm/robot.urdf", ""}).text;
}

class GoodChain : public ::testing::Test {
 protected:
  const LoadedRobot loaded_ = load_robot(kData + "chain");
  const JointConfig& turn_ = loaded_.robot.joints[0];
  const JointConfig& slide_ = loaded_.robot.joints[1];
  const JointConfig& roll_ = loaded_.robot.joints[2];
};

TEST_F(GoodChain, DriveSpeaksCia402) {
  EXPECT_EQ(turn_.drive.protocol, &protocol_named("cia402"));
  EXPECT_EQ(turn_.drive.command_id, 0x203U);
  EXPECT_EQ(turn_.drive.reply_id, 0x183U);
  EXPECT_EQ(turn_.drive.frames.command, 4);
  EXPECT_EQ(turn_.drive.frames.replies, std::vector<int>{24});  // link encoder: two more words
  EXPECT_EQ(roll_.drive.frames.replies, std::vector<int>{16});
  EXPECT_EQ(roll_.antagonist.frames.replies, std::vector<int>{16});
  EXPECT_EQ(turn_.drive.counts_per_turn, 4194304.0);
  EXPECT_EQ(turn_.drive.rated_torque_Nm, 2.0);
  EXPECT_FALSE(std::isfinite(turn_.drive.warning_temperature_degC));
  EXPECT_FALSE(std::isfinite(turn_.drive.limit_temperature_degC));
  EXPECT_NEAR(turn_.drive.range.torque_Nm, 65.534, 1e-9);
}

// Classic CAN, 8 bytes at most: status and position; velocity and torque, and the current where a
// sensor has taken the torque's place; the link's side.
TEST(ClassicChain, DrivesReportInSeveralFrames) {
  std::string yaml = good_yaml();
  yaml = testing::apply(yaml, {"", ", fd: true, bitrate_bps: 1000000, data_bitrate_bps: 5000000",
                               ", bitrate_bps: 1000000", ""})
             .text;
  yaml =
      testing::apply(yaml, {"", "encoder_bits: 22", "counts_per_turn: 2622532.2666667", ""}).text;
  yaml = testing::apply(yaml, {"", "    hold: {kp_Nm_per_rad: 5,",
                               "    link_encoder: {bits: 20}\n    hold: {kp_Nm_per_rad: 5,", ""})
             .text;
  const testing::TemporaryFolder folder;
  folder.write("robot.yaml", yaml);
  const Robot robot = load_robot(folder.path()).robot;
  EXPECT_EQ(robot.joints[0].drive.frames.command, 4);
  EXPECT_EQ(robot.joints[0].drive.frames.replies, (std::vector<int>{6, 8, 8}));
  EXPECT_EQ(robot.joints[2].drive.frames.replies, (std::vector<int>{6, 6, 8}));
  EXPECT_EQ(robot.joints[2].antagonist.frames.replies, (std::vector<int>{6, 6}));
  EXPECT_EQ(robot.joints[0].drive.counts_per_turn, 2622532.2666667);
}

TEST_F(GoodChain, ElectricActuator) {
  const ActuatorConfig& actuator = turn_.drive.actuator;
  EXPECT_EQ(actuator.kind, ActuatorKind::kCurrentDrive);
  EXPECT_EQ(actuator.resistance_ohm, 0.5);
  EXPECT_EQ(actuator.lag_s, 0.0005);
  EXPECT_EQ(actuator.inductance_H, 0.0003);
  EXPECT_EQ(actuator.back_emf_Vs_per_rad, 10.0);
  EXPECT_EQ(actuator.supply_V, 48.0);
  EXPECT_EQ(actuator.current_limit_A, 30.0);
  EXPECT_EQ(actuator.magnet_per_K, -0.0012);
  EXPECT_EQ(actuator.copper_per_K, 0.0039);
  EXPECT_EQ(actuator.thermal_resistance_K_per_W, 1.5);
  EXPECT_EQ(actuator.thermal_capacity_J_per_K, 150.0);
  EXPECT_EQ(actuator.cogging_Nm, 0.2);
  EXPECT_EQ(actuator.cogging_periods, 4200);
}

TEST_F(GoodChain, HydraulicActuator) {
  const ActuatorConfig& actuator = slide_.drive.actuator;
  EXPECT_EQ(actuator.kind, ActuatorKind::kHydraulic);
  EXPECT_EQ(actuator.fluid_stiffness_Nm_per_m3, 1e6);
  EXPECT_EQ(actuator.leakage_m3_per_s_per_Nm, 1e-5);
  EXPECT_EQ(actuator.displacement_m3_per_rad, 2e-5);
}

TEST_F(GoodChain, ElasticJointWithSensorsAndLoop) {
  EXPECT_EQ(turn_.transmission.kind, TransmissionKind::kElastic);
  EXPECT_EQ(turn_.transmission.spring.law, SpringLaw::kLinear);
  EXPECT_EQ(turn_.transmission.spring.stiffness_Nm_per_rad, 5000.0);
  EXPECT_EQ(turn_.transmission.damping_Nms_per_rad, 2.0);
  EXPECT_EQ(turn_.transmission.backlash_rad, 0.001);
  EXPECT_EQ(turn_.friction.coulomb_Nm, 2.0);
  EXPECT_EQ(turn_.link_friction.viscous_Nms_per_rad, 0.1);
  EXPECT_TRUE(turn_.link_encoder.present);
  EXPECT_EQ(turn_.link_encoder.bits, 20);
  EXPECT_EQ(turn_.link_encoder.errors.bias_rad, -0.001);
  EXPECT_EQ(turn_.link_encoder.errors.delay_s, 0.00025);
  EXPECT_EQ(turn_.motor_encoder.eccentricity_rad, 0.0003);
  EXPECT_EQ(turn_.motor_encoder.noise_rad, 2e-5);
  EXPECT_FALSE(roll_.motor_encoder.any());
  EXPECT_TRUE(turn_.torque_sensor.present);
  EXPECT_EQ(turn_.torque_sensor.resolution_Nm, 0.02);
  EXPECT_EQ(turn_.torque_sensor.noise_Nm, 0.05);
  EXPECT_EQ(turn_.torque_sensor.bias_Nm, -0.3);
  EXPECT_EQ(turn_.torque_sensor.scale, 1.01);
  EXPECT_EQ(turn_.torque_sensor.filter_s, 0.0003);
  EXPECT_EQ(turn_.torque_sensor.delay_s, 0.0005);
  EXPECT_TRUE(turn_.torque_loop.present());
  EXPECT_EQ(turn_.torque_loop.inertia_ratio, 4.0);
  EXPECT_EQ(turn_.torque_loop.rate_hz, 4000.0);
  EXPECT_EQ(turn_.torque_loop.delay_s, 0.0001);
  EXPECT_NEAR(turn_.apparent_rotor_inertia_kgm2(), 100.0 * 100.0 * 1e-4 / 4.0, 1e-12);
}

TEST_F(GoodChain, UnitsOfAPrismaticJoint) {
  EXPECT_EQ(slide_.transmission.spring.law, SpringLaw::kCubic);
  EXPECT_EQ(slide_.transmission.spring.stiffness_Nm_per_rad, 4000.0);
  EXPECT_EQ(slide_.transmission.spring.k3_Nm_per_rad3, 900.0);
  EXPECT_FALSE(slide_.link_encoder.present);
  EXPECT_FALSE(slide_.torque_sensor.present);
}

TEST_F(GoodChain, TwoMotorsOnOneJoint) {
  EXPECT_TRUE(roll_.has_antagonist);
  EXPECT_EQ(roll_.motors(), 2);
  EXPECT_EQ(loaded_.robot.motors(), 4);
  EXPECT_EQ(roll_.antagonist.command_id, 0x205U);
  EXPECT_EQ(roll_.antagonist.bus, roll_.drive.bus);
  EXPECT_EQ(roll_.antagonist.sign, -1.0);
  EXPECT_EQ(roll_.antagonist.offset_rad, 0.2);
  EXPECT_EQ(roll_.antagonist.hold_kp_Nm_per_rad, 5.0);
  EXPECT_EQ(roll_.antagonist.watchdog_s, 0.02);
  EXPECT_EQ(roll_.transmission.spring.k2_Nm_per_rad2, 400.0);
  EXPECT_EQ(roll_.transmission.preload_rad, 0.1);
  EXPECT_EQ(roll_.transmission.preload_max_rad, 0.6);
}

class ChainRefusal : public ::testing::TestWithParam<Mutation> {};

TEST_P(ChainRefusal, NamesPlaceAndProblem) {
  const testing::Mutated bad = testing::apply(good_yaml(), GetParam());
  const testing::TemporaryFolder folder;
  const std::string file = folder.write("robot.yaml", bad.text);
  const std::string complaint = testing::complaint_of([&] { load_robot(folder.path()); });
  testing::expect_complaint(complaint, file, bad.line, GetParam().expect);
}

const std::string kSensor =
    "    torque_sensor: {resolution_Nm: 0.02, noise_Nm: 0.05, bias_Nm: -0.3, scale: 1.01, "
    "filter_s: 0.0003, delay_s: 0.0005}\n";

const Mutation kSlips[] = {
    {"RatedTooSmall", "rated_torque_Nm: 2", "rated_torque_Nm: 1",
     "cannot carry the peak torque of 60: 32767 thousandths are 32.77"},
    {"RatedForMit", "    encoder_bits: 14", "    encoder_bits: 14\n    rated_torque_Nm: 1",
     "is for motors with protocol: cia402 only", 1},
    {"WarmWithoutTemperature", "    encoder_bits: 22",
     "    encoder_bits: 22\n    warning_temperature_degC: 70",
     "cia402 drives report no temperature, but warn by themselves", 1},
    {"WarmBeyondSense", "    encoder_bits: 14",
     "    encoder_bits: 14\n    warning_temperature_degC: 300", "from 20 to 200", 1},
    {"HotWithoutTemperature", "    encoder_bits: 22",
     "    encoder_bits: 22\n    limit_temperature_degC: 70",
     "cia402 drives report no temperature, but warn by themselves", 1},
    {"HotBeyondSense", "    encoder_bits: 14",
     "    encoder_bits: 14\n    limit_temperature_degC: 300", "from 20 to 200", 1},
    {"HotBeforeWarm", "    encoder_bits: 14",
     "    encoder_bits: 14\n    limit_temperature_degC: 80",
     "the limit, 80, must be above the warning, 80", 1},
    {"WarmAboveTheUsualLimit", "    encoder_bits: 14",
     "    encoder_bits: 14\n    warning_temperature_degC: 95",
     "the limit, 90, must be above the warning, 95", 1},
    {"ActuatorKind", "kind: current_drive", "kind: magic", "expected one of: ideal, current_drive"},
    {"ActuatorKey", "      lag_s: 0.0005", "      lagg_s: 0.0005", "unknown key 'lagg_s'"},
    {"MagnetGrowsStronger", "magnet_per_K: -0.0012", "magnet_per_K: 0.0012", "out of range"},
    {"NodeId", "id: 3", "id: 128", "from 1 to 127"},
    {"AntagonistTaken", "{id: 5,", "{id: 4,", "4 is taken by roll on the same bus"},
    {"AntagonistNodeOfAnother", "{id: 5,", "{id: 3,", "3 is taken by turn on the same bus"},
    {"SensorOnAnEmergencyId", "gains:",
     "tip_sensor:\n  model: ft\n  protocol: limber_ft\n  bus: left\n  id: 133\n  reply_id: 100\n"
     "  pose: {position_m: [0, 0, 0], rpy_rad: [0, 0, 0]}\n  range: {force_N: 9, torque_Nm: 9}\n"
     "gains:",
     "133 is taken by roll on the same bus", 4},
    {"SensorOnServiceData", "gains:",
     "tip_sensor:\n  model: ft\n  protocol: limber_ft\n  bus: left\n  id: 100\n"
     "  reply_id: 1411\n"
     "  pose: {position_m: [0, 0, 0], rpy_rad: [0, 0, 0]}\n  range: {force_N: 9, torque_Nm: 9}\n"
     "gains:",
     "1411 is taken by turn on the same bus", 5},
    {"AntagonistProtocol", "{id: 5,", "{motor: oil, id: 5,", "another protocol"},
    {"TwoKindsOfCounts", "    encoder_bits: 22", "    encoder_bits: 22\n    counts_per_turn: 16384",
     "counts_per_turn says it already: one of them"},
    {"NoCounts", "    encoder_bits: 22\n", "", "'encoder_bits' is missing", testing::kNoLine},
    {"CountsOfNothing", "encoder_bits: 22", "counts_per_turn: 0", "from 256 to 268435456"},
    {"CountsForMit", "    encoder_bits: 14", "    encoder_bits: 14\n    counts_per_turn: 16384",
     "is for motors with protocol: cia402 only", 1},
    {"TransmissionKind", "kind: elastic, spring: {law: linear", "kind: soft, spring: {law: linear",
     "expected one of: rigid, elastic, antagonistic"},
    {"AntagonisticNeedsTwo", "kind: elastic, spring: {law: linear",
     "kind: antagonistic, spring: {law: linear", "needs a second motor"},
    {"TwoNeedAntagonistic", "kind: antagonistic", "kind: elastic", "needs kind: antagonistic"},
    {"SpringLaw", "law: linear", "law: rubber", "expected one of: linear, quadratic"},
    {"SpringOfAnotherLaw", "law: linear, stiffness_Nm_per_rad: 5000",
     "law: linear, k2_Nm_per_rad2: 5000", "'stiffness_Nm_per_rad' is missing"},
    {"SpringStiffness", "stiffness_Nm_per_rad: 5000", "stiffness_Nm_per_rad: 0", "out of range"},
    {"SpringUnits", "stiffness_N_per_m: 4000", "stiffness_Nm_per_rad: 4000",
     "'stiffness_N_per_m' is missing"},
    {"PreloadOnOneMotor", "damping_Nms_per_rad: 2,", "preload_rad: 0.1,",
     "is for antagonistic joints only"},
    {"NoPreload", "preload_rad: 0.1", "preload_rad: 0", "leaves the joint without stiffness"},
    {"PreloadBeyondMost", "preload_rad: 0.1", "preload_rad: 0.7", "from 0 to 0.6"},
    {"LinkEncoderBits", "{bits: 20,", "{bits: 40,", "from 8 to 26"},
    {"EncoderNoiseNegative", "noise_rad: 2e-5", "noise_rad: -2e-5", "out of range"},
    {"EncoderKey", "eccentricity_rad: 0.0003", "wobble_rad: 0.0003", "unknown key 'wobble_rad'"},
    {"SensorNoiseNotANumber", "noise_Nm: 0.05", "noise_Nm: .nan", "'.nan' is not a number"},
    {"LoopWithoutSensor", kSensor, "", "torque_loop: needs a torque_sensor", testing::kNoLine},
    {"LoopSlowerThanTheCycle", "rate_hz: 4000", "rate_hz: 500", "from 1000 to 20000"},
    {"LoopNotAMultiple", "rate_hz: 4000", "rate_hz: 4500", "is no multiple of the 1000 Hz"},
    {"SensorOnAnMitDrive", "    home_m: 0.1", "    home_m: 0.1\n    link_encoder: {bits: 12}",
     "only drives with protocol: cia402 report", testing::kNoLine},
};
INSTANTIATE_TEST_SUITE_P(Slips, ChainRefusal, ::testing::ValuesIn(kSlips), testing::MutationName());

// Plant is merged key by key; what it does not say stays.
TEST(Plant, ChangesWhatItNames) {
  const YamlMap plant = YamlMap::from_text(
      "motors: {strong: {rotor_torque_constant_Nm_per_A: 0.09}}\n"
      "joints: {turn: {transmission: {spring: {stiffness_Nm_per_rad: 4000}}}}\n",
      "scenario.yaml");
  const Robot real = load_plant(kData + "chain", plant).robot;
  const Robot believed = load_robot(kData + "chain").robot;
  EXPECT_NEAR(real.joints[0].drive.torque_constant_Nm_per_A, 9.0, 1e-12);
  EXPECT_NEAR(believed.joints[0].drive.torque_constant_Nm_per_A, 10.0, 1e-12);
  EXPECT_EQ(real.joints[0].transmission.spring.stiffness_Nm_per_rad, 4000.0);
  EXPECT_EQ(real.joints[0].transmission.damping_Nms_per_rad, 2.0);
  EXPECT_EQ(real.joints[1].transmission.spring.k3_Nm_per_rad3, 900.0);
}

TEST(Plant, SlipNamesBothFiles) {
  const YamlMap plant =
      YamlMap::from_text("joints: {turn: {link_encoder: {bitz: 3}}}\n", "scenario.yaml");
  const std::string complaint = testing::complaint_of([&] { load_plant(kData + "chain", plant); });
  EXPECT_NE(complaint.find("chain/robot.yaml with scenario.yaml:1"), std::string::npos)
      << complaint;
  EXPECT_NE(complaint.find("unknown key 'bitz'"), std::string::npos) << complaint;
}

}  // namespace
}  // namespace limber::test_joint_chain_yaml
