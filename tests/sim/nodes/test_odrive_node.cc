// The emulated ODrive axis, byte by byte where bytes matter.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limber/scenario_event_t.hpp>
#include <numbers>
#include <string>

#include "robots/loader/protocols/drive_protocol.h"
#include "sim/nodes/odrive_node.h"
#include "tests/sim/test_arms.h"
#include "tests/support/frame_text.h"

namespace limber::sim::test_odrive_node {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr double kTurn_rad = 2.0 * std::numbers::pi;
const std::string kTorqueMode = "04B#0100000001000000";
const std::string kLoop = "047#08000000";
const std::string kLimits = "04F#0000C84200002041";  // 100 turns/s, 10 A
const std::string kTorque = "04E#CDCC4CBE";          // -0.2 N m

/// Node 2, geared 8 to 1.
JointConfig joint2() {
  JointConfig joint = testing::joint_config(0, JointType::kRevolute, 0.0);
  joint.drive.protocol = &protocol_named("odrive");
  joint.drive.command_id = 0x4E;
  joint.drive.reply_id = 0x49;
  joint.drive.gear_ratio = 8.0;
  joint.drive.counts_per_turn = 8.0 * 16384.0;
  joint.drive.peak_torque_Nm = 12.0;
  joint.drive.torque_constant_Nm_per_A = 0.5;
  joint.drive.firmware = 0x00060B;
  joint.drive.endpoints = {223, 243, 244, 275, 378, 379, 384};
  return joint;
}

class OdriveNodeTest : public ::testing::Test {
 protected:
  std::string send(const std::string& candump) {
    CanFrame frame = limber::testing::parse(candump.substr(0, candump.find('R')));
    frame.remote = candump.ends_with("R");
    return node_.receive(frame, joint_, now_, &reply_) ? limber::testing::text(reply_) : "none";
  }
  /// What it sends unasked, in steps of a millisecond.
  std::string wait(std::int64_t ns) {
    std::string heard;
    CanFrame frame;
    for (const std::int64_t end = now_ + ns; now_ < end;) {
      now_ += std::min(kMs, end - now_);
      node_.update(joint_, now_);
      while (node_.next_frame(&frame)) heard += limber::testing::text(frame) + "\n";
    }
    return heard;
  }
  void run() {
    for (const std::string& frame : {kTorqueMode, kLimits, kLoop}) EXPECT_EQ(send(frame), "none");
  }

  OdriveNode node_{joint2()};
  JointReading joint_;
  std::int64_t now_ = 0;
  CanFrame reply_;
};

TEST_F(OdriveNodeTest, AnswersRemoteAndEmptyFramesOnly) {
  joint_.theta = 2.0 / 8.0 + 1e-6;  // of the motor 2 rad: a third of a turn, whole counts below
  joint_.theta_dot = -1.5 * kTurn_rad / 8.0;
  joint_.motor_torque = -0.1875 * 8.0;
  EXPECT_EQ(send("049#R"), send("049#"));
  EXPECT_NEAR(odrive::field<float>(reply_, 0), 0.31831, 1.0 / 16384.0);
  EXPECT_EQ(odrive::field<float>(reply_, 4), -1.5F);
  EXPECT_EQ(send("05C#R"), "05C#00000000000040BE") << "no torque is wanted, one is made";
  EXPECT_EQ(send("040#R"), "040#0204040000060B00");
  EXPECT_EQ(send("043#R"), "043#0000000000000000");
  EXPECT_EQ(send("041#R"), "041#0000000001000100");
  EXPECT_EQ(send("7E6#R"), "046#0202000000003000");
  EXPECT_EQ(send("055#R"), "055#0000F0410000F041");
  EXPECT_EQ(send("057#R"), "057#0000404200000000");
  for (const char* other : {"069#R", "7E9#R", "04E#R", "04E#", "052#R", "04E#00000000", "049#00"})
    EXPECT_EQ(send(other), "none") << other;
  CanFrame extended = limber::testing::parse("049#");
  extended.extended = true;
  EXPECT_FALSE(node_.receive(extended, joint_, now_, &reply_));
}

TEST_F(OdriveNodeTest, AsDeliveredItTalksAndHoldsNothing) {
  const std::string heard = wait(400 * kMs);
  EXPECT_EQ(std::ranges::count(heard, '\n'), 4 + 40);
  EXPECT_NE(heard.find("041#0000000001000100"), std::string::npos);
  EXPECT_EQ(send("044#0013010000000000"), "045#001301000A000000");
  EXPECT_EQ(send("044#0113010000000000"), "none") << "a write";
  EXPECT_EQ(send("044#0013010000000000"), "045#0013010000000000");
  EXPECT_EQ(std::ranges::count(wait(400 * kMs), '\n'), 4);
  EXPECT_EQ(send("044#00F4000000000000"), "045#00F4000000") << "no watchdog";
  EXPECT_EQ(send("044#007A010000000000"), "045#007A010003") << "position control";
  send(kLoop);
  send(kTorque);
  EXPECT_TRUE(node_.enabled());
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0);
  send(kTorqueMode);
  EXPECT_NEAR(node_.law().torque(0.0, 0.0), -1.6, 1e-6);
  EXPECT_EQ(wait(1000 * kMs).find("\n041#0000000101"), std::string::npos);
  EXPECT_NEAR(node_.law().torque(0.0, 0.0), -1.6, 1e-6) << "for ever";
}

// A sixth of a N m s a turn: at 2 turns/s a third of a N m of the motor at rest, nothing at 2.
TEST_F(OdriveNodeTest, ItsVelocityLimitTakesTorqueAwayBelowIt) {
  send(kTorqueMode);
  send(kLoop);
  send("04E#0000803F");  // 1 N m
  EXPECT_NEAR(node_.law().torque(0.0, 0.0), 8.0 / 3.0, 1e-6);
  joint_.theta_dot = 2.0 * kTurn_rad / 8.0;
  wait(kMs);
  EXPECT_NEAR(node_.law().torque(0.0, 0.0), 0.0, 1e-6);
  send(kLimits);
  EXPECT_EQ(send("044#0080010000000000"), "045#008001000000C842");
  EXPECT_NEAR(node_.law().torque(0.0, 0.0), 5.0, 1e-6) << "10 A, 0.5 N m each";
}

TEST_F(OdriveNodeTest, TheWatchdogIsFedByTorquesAlone) {
  run();
  send("044#01F30000CDCCCC3D");  // 0.1 s
  send("044#01F4000001");
  EXPECT_EQ(send("044#00F3000000000000"), "045#00F30000CDCCCC3D");
  for (int i = 0; i < 10; ++i) {
    send(kTorque);
    wait(90 * kMs);
  }
  EXPECT_TRUE(node_.enabled());
  for (int i = 0; i < 3; ++i) {
    send("049#R");
    wait(9 * kMs);
  }
  EXPECT_FALSE(node_.enabled());
  EXPECT_EQ(node_.law().torque(0.0, 1.0), 0.0);
  EXPECT_EQ(send("041#R"), "041#0000000101030100");
  EXPECT_EQ(send("043#R"), "043#0000000100000001");
  send(kLoop);
  EXPECT_FALSE(node_.enabled()) << "not before it is cleared";
  send("058#");
  EXPECT_EQ(send("043#R"), "043#0000000000000000");
  EXPECT_FALSE(node_.enabled());
  send(kLoop);
  EXPECT_TRUE(node_.enabled());
}

TEST_F(OdriveNodeTest, UncalibratedItHasNoEstimateAndNoLoop) {
  EXPECT_EQ(send("056#02"), "none");  // erases
  EXPECT_EQ(wait(400 * kMs), "") << "starts";
  EXPECT_EQ(send("049#R"), "none") << "no number";
  wait(200 * kMs);
  EXPECT_EQ(send("7E6#R"), "7E6#3F02000000003000");
  send("7E6#0202000000003000");
  EXPECT_EQ(send("040#R"), "040#0204040000060B00") << "the number it was given";
  send("049#R");
  EXPECT_TRUE(std::isnan(odrive::field<float>(reply_, 0)));
  send(kLoop);
  EXPECT_EQ(send("041#R"), "041#00000000010E0100");
  EXPECT_FALSE(node_.enabled());
  send("047#03000000");
  send(kLoop);
  EXPECT_TRUE(node_.enabled());
  send("7E6#0302000000003100");
  EXPECT_NE(send("040#R"), "none") << "another's serial number";
}

TEST_F(OdriveNodeTest, ARebootForgetsWhatWasNotSavedAndItsTurns) {
  joint_.theta = 0.25;   // 0.318 turns of the motor
  send("059#00004041");  // is at 12 turns
  send("049#R");
  EXPECT_NEAR(odrive::field<float>(reply_, 0), 12.0F, 1e-4);
  run();
  send("056#00");
  EXPECT_FALSE(node_.enabled());
  wait(600 * kMs);
  EXPECT_EQ(send("044#007A010000000000"), "045#007A010003");
  send("049#R");
  EXPECT_NEAR(odrive::field<float>(reply_, 0), 0.0F, 0.51F);
  send(kTorqueMode);
  send("056#01");  // saves
  wait(600 * kMs);
  EXPECT_EQ(send("044#007A010000000000"), "045#007A010001");
}

TEST_F(OdriveNodeTest, FaultsOnDemand) {
  run();
  send(kTorque);
  joint_.theta = 0.1;
  joint_.theta_dot = 1.0;
  node_.inject(scenario_event_t::FAULT_FROZEN_ENCODER, joint_, now_ + 10 * kMs);
  const std::string frozen = send("049#R");
  joint_.theta = 0.2;
  EXPECT_EQ(send("049#R"), frozen);
  EXPECT_EQ(odrive::field<float>(reply_, 4), 0.0F);
  EXPECT_NEAR(node_.law().torque(0.2, 1.0), -1.6, 1e-6);
  wait(11 * kMs);
  EXPECT_NE(send("049#R"), frozen);
  node_.inject(scenario_event_t::FAULT_SILENT, joint_, now_ + 200 * kMs);
  EXPECT_EQ(send("049#R"), "none");
  EXPECT_EQ(wait(150 * kMs), "");
  node_.clear_faults();
  node_.inject(scenario_event_t::FAULT_DROP_COMMANDS, joint_, now_ + 10 * kMs);
  send("04E#00000000");
  send("047#01000000");
  EXPECT_NE(send("049#R"), "none");
  EXPECT_NEAR(node_.law().torque(0.2, 1.0), -1.6, 1e-6);
  node_.clear_faults();
  node_.inject(scenario_event_t::FAULT_DRIVE_ERROR, joint_, now_ + 50 * kMs);
  EXPECT_EQ(send("043#R"), "043#0004000000040000");
  EXPECT_FALSE(node_.enabled());
  send("058#");
  send(kLoop);
  EXPECT_FALSE(node_.enabled()) << "its cause is there";
  wait(60 * kMs);
  send("058#");
  send(kLoop);
  EXPECT_TRUE(node_.enabled());
  send("042#");
  EXPECT_EQ(send("043#R"), "043#0000000200000002") << "emergency stop";
}

TEST_F(OdriveNodeTest, WhatIsNotANumberMakesNoTorque) {
  run();
  for (const char* frame : {"04E#0000C07F", "04E#0000807F", "04F#0000C07F0000C07F"}) {
    send(kTorque);
    send(frame);
    EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0) << frame;
    EXPECT_TRUE(std::isfinite(node_.law().limit));
  }
}

}  // namespace
}  // namespace limber::sim::test_odrive_node
