// The `hand:` section: what a good one means, and one slip in it each.
#include <cmath>

#include "tests/robots/arm_folder.h"

namespace limber::test_hand_yaml {
namespace {

using testing::Mutation;

const std::string& kData = testing::kArmData;

std::string good_yaml() { return testing::arm_yaml_with("hand.yaml"); }

using Folder = testing::ArmFolder;

TEST(HandYaml, Absent) {
  const Robot robot = load_robot(kData + "arm/").robot;
  EXPECT_FALSE(robot.hand);
  EXPECT_EQ(robot.motors(), 3);
  EXPECT_EQ(robot.driven().size(), 3U);
}

TEST(HandYaml, Complete) {
  const Folder good(good_yaml());
  const Robot robot = load_robot(good.folder.path()).robot;
  ASSERT_TRUE(robot.hand);
  const HandConfig& hand = *robot.hand;
  EXPECT_EQ(robot.size(), 3);
  EXPECT_EQ(robot.motors(), 4);
  EXPECT_EQ(robot.driven_names().back(), "hand");
  EXPECT_EQ(hand.drive.drive.command_id, 8U);
  EXPECT_EQ(hand.drive.drive.reply_id, 24U);
  EXPECT_EQ(hand.drive.drive.bus, 0);
  EXPECT_EQ(hand.drive.drive.sign, -1.0);
  EXPECT_EQ(hand.drive.drive.watchdog_s, 0.02);
  EXPECT_EQ(hand.drive.drive.watchdog_reaction, NodeWatchdogReaction::kOff);
  EXPECT_DOUBLE_EQ(hand.drive.position_min, 0.1) << "a tenth of the travel beyond its end";
  EXPECT_DOUBLE_EQ(hand.drive.position_max, 1.3);
  EXPECT_EQ(hand.drive.home, 1.2) << "open";
  EXPECT_DOUBLE_EQ(hand.travel.steepest(), 0.1);
  EXPECT_DOUBLE_EQ(hand.travel.flattest(), 0.06);
  EXPECT_DOUBLE_EQ(hand.drive.torque_limit_Nm, 80.0 * 0.1);
  EXPECT_DOUBLE_EQ(hand.drive.torque_rate_limit_Nm_per_s, 80.0 * 0.1 / 0.02);
  EXPECT_EQ(hand.hold_force_N, 30.0);
  EXPECT_EQ(hand.drive.friction.coulomb_Nm, 0.1);
  EXPECT_EQ(hand.drive.drive.hold_kp_Nm_per_rad, 10.0);
  EXPECT_EQ(hand.p_TG[2], 0.1);
  // 81 * 0.0002 kg m^2 behind the gear, and two fingers that move by half of the width each.
  EXPECT_NEAR(hand.mass_kg(0.1), 81 * 0.0002 / 0.01 + 0.025, 1e-12);
}

TEST(HandYaml, HoldsWithTheContinuousTorqueUnlessLess) {
  const Mutation without = {"", "  hold_force_N: 30\n", "", ""};
  const Folder good(testing::apply(good_yaml(), without).text);
  EXPECT_DOUBLE_EQ(load_robot(good.folder.path()).robot.hand->hold_force_N, 4.0 / 0.1);
}

class HandRefusal : public ::testing::TestWithParam<Mutation> {};

TEST_P(HandRefusal, NamesPlaceAndProblem) { testing::expect_refused(good_yaml(), GetParam()); }

const Mutation kSlips[] = {
    {"UnknownKey", "  id: 8\n", "  id: 8\n  width: 3\n", "unknown key 'width'", 1},
    {"MotorUnknown", "motor: big\n  bus: left\n  id: 8", "motor: bigger\n  bus: left\n  id: 8",
     "expected one of: big, linear"},
    {"IdTaken", "id: 8\n", "id: 1\n", "1 is taken by turn on the same bus"},
    {"ReplyTaken", "reply_id: 24", "reply_id: 18", "18 is taken by slide on the same bus"},
    {"TravelMissing", "  travel: {width_m: [0, 0.03, 0.08], angle_rad: [0.2, 0.7, 1.2]}\n", "",
     "'travel' is missing", testing::kNoLine},
    {"OnePoint", "[0, 0.03, 0.08], angle_rad: [0.2, 0.7, 1.2]", "[0], angle_rad: [0.2]",
     "found 1 points; expected 2 to 16"},
    {"FewerAngles", "[0.2, 0.7, 1.2]", "[0.2, 0.7]", "found 2 angles for 3 widths"},
    {"WidthNegative", "[0, 0.03", "[-0.01, 0.03", "'-0.01' is out of range"},
    {"WidthsFall", "[0, 0.03, 0.08]", "[0, 0.09, 0.08]", "0.08 follows 0.09; expected widths"},
    {"AnglesTurnBack", "[0.2, 0.7, 1.2]", "[0.2, 0.7, 0.5]", "0.5 follows 0.7; expected angles"},
    {"AnglesAlike", "[0.2, 0.7, 1.2]", "[0.2, 0.7, 0.7]", "0.7 follows 0.7; expected angles"},
    {"WidthNotANumber", "[0, 0.03, 0.08]", "[0, .nan, 0.08]", "'.nan' is not a number"},
    {"BeyondTheDrivesRange", "[0.2, 0.7, 1.2]", "[0.2, 0.7, 13]", "drive's position range",
     testing::kNoLine},
    {"ForceBeyondTheMotor", "force_limit_N: 80", "force_limit_N: 160",
     "160 N needs 16 N m where the travel table is steepest; the motor's 15 allow 150 N"},
    {"ForceZero", "force_limit_N: 80", "force_limit_N: 0", "out of range"},
    {"HoldBeyondTheForce", "hold_force_N: 30", "hold_force_N: 90", "out of range"},
    {"HoldBeyondForEver", "hold_force_N: 30", "hold_force_N: 50",
     "50 is more than the 40 N that continuous_torque_Nm holds for ever"},
    {"ContinuousBeyondThePeak", "continuous_torque_Nm: 4", "continuous_torque_Nm: 16",
     "16 is more than the motor's peak, 15"},
    {"SpeedBeyondTheMotor", "speed_limit_m_per_s: 0.2", "speed_limit_m_per_s: 0.3",
     "0.3 is more than the 0.24 of velocity_limit_rad_per_s"},
    {"VelocityBeyondTheDrive", "velocity_limit_rad_per_s: 4\n", "velocity_limit_rad_per_s: 5\n",
     "5 is more than the 4 that the drive reports"},
    {"DampingUnstable", "damping_Ns_per_m: 40", "damping_Ns_per_m: 900",
     "900 with 1.64 kg of motor and fingers is unstable at 500 Hz"},
    {"StiffnessUnstable", "stiffness_N_per_m: 2000", "stiffness_N_per_m: 11000",
     "11000 with a damping of 40 is unstable at 500 Hz; at most 1e+04"},
    {"HeatTimeZero", "heat_time_constant_s: 20", "heat_time_constant_s: 0", "out of range"},
    {"HoldMissing", "  hold: {kp_Nm_per_rad: 10, kd_Nms_per_rad: 0.5}\n", "", "'hold' is missing",
     testing::kNoLine},
};
INSTANTIATE_TEST_SUITE_P(Slips, HandRefusal, ::testing::ValuesIn(kSlips), testing::MutationName());

TEST(HandYaml, LeavesNoIdOfItsToASensor) {
  const std::string sensor = testing::read_text(kData + "tip_sensor.yaml");
  std::string yaml = good_yaml() + sensor;
  for (const Mutation& change : {Mutation{"", "motor: big\n  bus: left\n  id: 8\n  reply_id: 24",
                                          "motor: big\n  bus: right\n  id: 8\n  reply_id: 24", ""},
                                 Mutation{"", "[5, 6]", "[5, 24]", ""}}) {
    yaml = testing::apply(yaml, change).text;
  }
  const Folder folder(yaml);
  const std::string complaint = testing::complaint_of([&] { load_robot(folder.folder.path()); });
  EXPECT_NE(complaint.find("24 is taken by hand on the same bus"), std::string::npos) << complaint;
}

}  // namespace
}  // namespace limber::test_hand_yaml
