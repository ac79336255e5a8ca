// The emulated CubeMars drive, byte by byte where bytes matter.
#include <gtest/gtest.h>

#include <limber/scenario_event_t.hpp>
#include <string>

#include "robots/loader/protocols/drive_protocol.h"
#include "sim/nodes/cubemars_node.h"
#include "tests/sim/test_arms.h"
#include "tests/support/frame_text.h"

namespace limber::sim::test_cubemars_node {
namespace {

constexpr std::int64_t kMs = 1'000'000;
const std::string kEnable = "002#FFFFFFFFFFFFFFFC";
const std::string kDisable = "002#FFFFFFFFFFFFFFFD";
const std::string kZero = "002#FFFFFFFFFFFFFFFE";
const std::string kCommand = "002#8A3D7AE1EB4CC91C";  // 1 rad, -2 rad/s, 60, 1.5, 2.5 N m
const std::string kAtRest = "000#027FFF7FF7FF1E00";   // 30 degC

/// Motor 2, an AK80-9.
JointConfig motor2(int board) {
  JointConfig joint = testing::joint_config(0, JointType::kRevolute, 0.0);
  joint.drive.protocol = &protocol_named("cubemars");
  joint.drive.board = board;
  joint.drive.command_id = board == cubemars::kV3 ? 0x802 : 2;
  joint.drive.reply_id = board == cubemars::kV3 ? 0x2902 : 0;
  joint.drive.range = {12.5, 50.0, 18.0, 500.0, 5.0};
  joint.drive.gear_ratio = 9.0;
  joint.drive.torque_constant_Nm_per_A = 2.0;
  return joint;
}

class CubemarsNodeTest : public ::testing::Test {
 protected:
  std::string send(const std::string& candump) { return send(&node_, candump); }
  std::string send(CubemarsNode* node, const std::string& candump) {
    CanFrame frame = limber::testing::parse(candump);
    frame.extended = candump.find('#') > 3;
    return node->receive(frame, joint_, now_, &reply_) ? limber::testing::text(reply_) : "none";
  }
  void wait(std::int64_t ns) {
    now_ += ns;
    node_.update(joint_, now_);
  }

  CubemarsNode node_{motor2(cubemars::kV2)};
  JointReading joint_;
  std::int64_t now_ = 0;
  CanFrame reply_;
};

TEST_F(CubemarsNodeTest, EveryFrameForItIsAnsweredAndNothingElse) {
  for (const std::string& frame : {kDisable, kCommand, kEnable, kCommand})
    EXPECT_EQ(send(frame), kAtRest) << "no answer tells whether it is on";
  EXPECT_EQ(send("003#FFFFFFFFFFFFFFFC"), "none") << "another motor";
  EXPECT_EQ(send("002#FFFFFFFFFFFFFF"), "none");
  EXPECT_EQ(send("00000802#1EB4CC8A3D7AE91C"), "none") << "of a V3";
  CanFrame frame;
  EXPECT_FALSE(node_.next_frame(&frame));
}

TEST_F(CubemarsNodeTest, TheCommandIsObeyedWhileItIsOn) {
  send(kCommand);
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0) << "not enabled";
  send(kEnable);
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0) << "no command yet";
  send(kCommand);
  EXPECT_NEAR(node_.law().torque(0.95, -1.9), 60.0 * 0.05 + 1.5 * -0.1 + 2.5, 0.05);
  EXPECT_EQ(node_.law().torque(-100.0, 0.0), 7.0) << "its peak";
  send(kEnable);
  EXPECT_NE(node_.law().torque(0.0, 0.0), 0.0) << "a poll changes nothing";
  send(kDisable);
  EXPECT_FALSE(node_.enabled());
  EXPECT_EQ(node_.law().torque(0.95, 0.0), 0.0);
  EXPECT_EQ(node_.law().passive_damping, 0.0);
}

TEST_F(CubemarsNodeTest, ThereIsNoWatchdog) {
  send(kEnable);
  send(kCommand);
  wait(3'600'000 * kMs);
  EXPECT_TRUE(node_.enabled());
  EXPECT_NE(node_.law().torque(0.0, 0.0), 0.0);
}

TEST_F(CubemarsNodeTest, ANewZeroSilencesItForMoreThanASecond) {
  joint_.theta = 1.0;
  send(kEnable);
  EXPECT_EQ(send(kZero), "none");
  wait(1100 * kMs);
  EXPECT_EQ(send(kDisable), "none");
  EXPECT_TRUE(node_.enabled()) << "deaf";
  wait(200 * kMs);
  EXPECT_EQ(send(kDisable), kAtRest);
}

TEST_F(CubemarsNodeTest, AnErrorSwitchesItOffAndGoesWithItsCause) {
  send(kEnable);
  send(kCommand);
  node_.inject(scenario_event_t::FAULT_DRIVE_ERROR, joint_, 10 * kMs);
  wait(kMs);
  EXPECT_EQ(send(kEnable), "000#027FFF7FF7FF1E02") << "over-current";
  EXPECT_FALSE(node_.enabled());
  wait(10 * kMs);
  EXPECT_EQ(send(kCommand), kAtRest);
  EXPECT_FALSE(node_.enabled()) << "not by itself";
  send(kEnable);
  EXPECT_TRUE(node_.enabled());
}

TEST_F(CubemarsNodeTest, AV1TellsNeitherTemperatureNorError) {
  CubemarsNode v1(motor2(cubemars::kV1));
  EXPECT_EQ(send(&v1, kEnable), "000#027FFF7FF7FF");
  v1.inject(scenario_event_t::FAULT_DRIVE_ERROR, joint_, 10 * kMs);
  v1.update(joint_, kMs);
  EXPECT_EQ(send(&v1, kEnable), "000#027FFF7FF7FF");
  EXPECT_FALSE(v1.enabled());
}

TEST_F(CubemarsNodeTest, AV3NeedsNoEnabling) {
  CubemarsNode v3(motor2(cubemars::kV3));
  joint_.theta = 0.5;
  EXPECT_EQ(send(&v3, "00000802#1EB4CC8A3D7AE91C"), "2902#011E000000001E00") << "28.6 degrees";
  EXPECT_NEAR(v3.law().torque(0.95, -1.9), 60.0 * 0.05 + 1.5 * -0.1 + 2.5, 0.05);
  send(&v3, "00000102#00000000");
  EXPECT_FALSE(v3.enabled()) << "no current";
  EXPECT_EQ(send(&v3, "00000803#1EB4CC8A3D7AE91C"), "none");
  EXPECT_EQ(send(&v3, "002#FFFFFFFFFFFFFFFD"), "none") << "of a V2";
  EXPECT_EQ(send(&v3, "00000502#00"), "none") << "a new zero";
}

TEST_F(CubemarsNodeTest, FaultsOfTheBus) {
  send(kEnable);
  node_.inject(scenario_event_t::FAULT_DROP_COMMANDS, joint_, 10 * kMs);
  EXPECT_EQ(send(kCommand), kAtRest);
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0) << "not taken in";
  wait(11 * kMs);
  node_.inject(scenario_event_t::FAULT_SILENT, joint_, now_ + 10 * kMs);
  EXPECT_EQ(send(kCommand), "none");
  EXPECT_NE(node_.law().torque(0.0, 0.0), 0.0) << "but obeyed";
}

}  // namespace
}  // namespace limber::sim::test_cubemars_node
