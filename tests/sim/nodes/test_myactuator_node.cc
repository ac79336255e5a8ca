// The emulated MyActuator drive, byte by byte where bytes matter.
#include <gtest/gtest.h>

#include <limber/scenario_event_t.hpp>
#include <numbers>
#include <string>

#include "robots/loader/protocols/drive_protocol.h"
#include "sim/nodes/myactuator_node.h"
#include "tests/sim/test_arms.h"
#include "tests/support/frame_text.h"

namespace limber::sim::test_myactuator_node {
namespace {

constexpr std::int64_t kMs = 1'000'000;
const std::string kNothing = "401#7FFF7FF0000007FF";
const std::string kCommand = "401#8A3D7A51EB6668D5";  // 1 rad, -2 rad/s, 60, 2, 2.5 N m
const std::string kRelease = "141#7700000000000000";
const std::string kOff = "141#8000000000000000";
const std::string kStatus = "141#9A00000000000000";
const std::string kTimedOut = "241#F100000000000000";
const std::string kState = "501#017FFF7FF7FF0000";

/// Motor 1: an X8 of V4.2 that lets go by itself, not damped.
JointConfig motor1() {
  JointConfig joint = testing::joint_config(0, JointType::kRevolute, 0.0);
  joint.drive.protocol = &protocol_named("myactuator");
  joint.drive.command_id = 0x401;
  joint.drive.reply_id = 0x501;
  joint.drive.range = {12.5, 45.0, 24.0, 500.0, 5.0};
  joint.drive.watchdog_reaction = NodeWatchdogReaction::kOff;
  return joint;
}

JointConfig with_v44() {
  JointConfig joint = motor1();
  joint.drive.range = {12.566, 45.0, 129.0, 500.0, 50.0};
  return joint;
}

class MyactuatorNodeTest : public ::testing::Test {
 protected:
  /// The answer, "501#...", or "none".
  std::string send(const std::string& candump) { return send(&node_, candump); }
  std::string send(MyactuatorNode* node, const std::string& candump) {
    CanFrame reply;
    if (!node->receive(limber::testing::parse(candump), joint_, now_, &reply)) return "none";
    return limber::testing::text(reply);
  }
  void wait(std::int64_t ns) {
    for (const std::int64_t end = now_ + ns; now_ < end;) {
      now_ += kMs;
      node_.update(joint_, now_);
    }
  }
  std::string unasked() {
    CanFrame frame;
    return node_.next_frame(&frame) ? limber::testing::text(frame) : "none";
  }
  void turn(double angle) { joint_.theta = joint_.q = angle; }
  void switch_on() {
    send(kRelease);
    send(kCommand);
    ASSERT_TRUE(node_.enabled());
  }

  MyactuatorNode node_{motor1()};
  MyactuatorNode v44_{with_v44()};
  JointReading joint_;
  std::int64_t now_ = 0;
};

TEST_F(MyactuatorNodeTest, TheFirstMotionCommandActsOnceTheBrakeIsReleased) {
  EXPECT_EQ(send(kCommand), kState) << "from before it";
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0) << "locked";
  EXPECT_EQ(send(kRelease), "241#7700000000000000");
  EXPECT_NEAR(node_.law().torque(0.95, -1.9), 60.0 * 0.05 + 2.0 * -0.1 + 2.5, 0.05);
  EXPECT_EQ(node_.law().torque(-100.0, 0.0), 7.0) << "its peak";
  EXPECT_EQ(send(kOff), "241#8000000000000000");
  EXPECT_EQ(node_.law().torque(0.95, 0.0), 0.0);
  EXPECT_EQ(send(kStatus), "241#9A1E0000E0010000") << "30 degC, locked, 48 V";
  EXPECT_EQ(send("402#7FFF7FF0000007FF"), "none") << "another motor";
  EXPECT_EQ(send("401#7FFF7FF0000007"), "none");
  EXPECT_EQ(send("141#4200000000000000"), "none") << "an order that is not emulated";
  EXPECT_EQ(send("280#9A00000000000000"), "241#9A1E0000E0010000") << "to all";
}

TEST_F(MyactuatorNodeTest, ItsFirmwareTellsWhatACommandMeans) {
  EXPECT_EQ(send("141#B200000000000000"), "241#B20000007A1EB478") << "2025070202";
  EXPECT_EQ(send("141#B501010000000000"), "241#B558385332563130") << "X8S2V10";
  EXPECT_EQ(send(&v44_, "141#B200000000000000"), "241#B200000022F4C278") << "2026042402";
  EXPECT_EQ(send(&v44_, "141#B501010000000000"), "241#B50101524D442D58") << "RMD-X";
  EXPECT_EQ(send(&v44_, "141#B501020000000000"), "241#B50102382D503230") << "8-P20";
  send(&v44_, kRelease);
  send(&v44_, "401#7FFF7FF000000855");  // 2.5 N m of 60
  EXPECT_NEAR(v44_.law().tau_ff, 2.5 * 129.0 / 60.0, 0.07);
  switch_on();
  send("401#7FFF7FF000000855");
  EXPECT_NEAR(node_.law().tau_ff, 1.0, 0.02) << "of 24";
}

TEST_F(MyactuatorNodeTest, TheWatchdogIsOffWhenItIsDelivered) {
  switch_on();
  wait(1000 * kMs);
  EXPECT_TRUE(node_.enabled());
  EXPECT_EQ(unasked(), "none");
}

TEST_F(MyactuatorNodeTest, AfterATimeOutTheFirstFrameIsSentBackAndTheSecondActs) {
  EXPECT_EQ(send("141#B300000014000000"), "241#B300000014000000");  // 20 ms
  switch_on();
  wait(20 * kMs);
  EXPECT_TRUE(node_.enabled());
  wait(kMs);
  EXPECT_FALSE(node_.enabled());
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0);
  EXPECT_EQ(unasked(), kTimedOut);
  EXPECT_EQ(unasked(), "none");
  wait(999 * kMs);
  EXPECT_EQ(unasked(), "none");
  wait(kMs);
  EXPECT_EQ(unasked(), kTimedOut) << "every second";
  EXPECT_EQ(send(kCommand), "501#8A3D7A51EB6668D5") << "sent back";
  send(kRelease);
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0);
  EXPECT_EQ(send(kCommand), kState);
  EXPECT_TRUE(node_.enabled()) << "as if nothing had been";
  wait(21 * kMs);
  EXPECT_EQ(unasked(), kTimedOut);
  turn(1.0);
  EXPECT_EQ(send("141#9200000000000000"), "241#9200000000000000") << "sent back";
  EXPECT_EQ(send("141#9200000000000000"), "241#9200000060160000") << "57.28 degrees";
}

TEST_F(MyactuatorNodeTest, AnErrorShowsInTheStatusAlone) {
  switch_on();
  node_.inject(scenario_event_t::FAULT_DRIVE_ERROR, joint_, now_ + 50 * kMs);
  EXPECT_FALSE(node_.enabled());
  EXPECT_EQ(unasked(), "none") << "not switched on";
  EXPECT_EQ(send("141#2003000001000000"), "241#2003000001000000");
  EXPECT_EQ(unasked(), "241#9A1E0000E0010400");
  EXPECT_EQ(unasked(), "none");
  EXPECT_EQ(send(kCommand), kState) << "as ever";
  send(kRelease);
  EXPECT_FALSE(node_.enabled());
  wait(51 * kMs);
  EXPECT_EQ(send(kStatus), "241#9A1E0000E0010000") << "with its cause";
  EXPECT_FALSE(node_.enabled());
  switch_on();
}

TEST_F(MyactuatorNodeTest, AnErrorIsToldAgainEvery100Ms) {
  send("141#2003000001000000");
  node_.inject(scenario_event_t::FAULT_DRIVE_ERROR, joint_, now_ + 1000 * kMs);
  EXPECT_EQ(unasked(), "241#9A1E0000E0010400");
  wait(99 * kMs);
  EXPECT_EQ(unasked(), "none");
  wait(kMs);
  EXPECT_EQ(unasked(), "241#9A1E0000E0010400");
}

TEST_F(MyactuatorNodeTest, AResetTakesItsTimeAndCountsFromASingleTurn) {
  switch_on();
  turn(2.0 * std::numbers::pi + 1.0);
  EXPECT_EQ(send("141#2005000005000000"), "241#2005000005000000");
  EXPECT_EQ(send(kNothing).substr(0, 6), "501#01") << "its old number";
  EXPECT_EQ(send("141#7600000000000000"), "none");
  EXPECT_FALSE(node_.enabled());
  wait(1099 * kMs);
  EXPECT_EQ(send("145#9200000000000000"), "none");
  wait(kMs);
  EXPECT_EQ(send("145#9200000000000000"), "245#9200000060160000") << "57.28 degrees";
  EXPECT_EQ(send("141#9200000000000000"), "none");
}

TEST_F(MyactuatorNodeTest, AtAnotherBitRateItNeitherHearsNorAnswers) {
  EXPECT_EQ(send("141#B400000000000001"), "none") << "1 Mbit/s, which it has";
  EXPECT_EQ(send("141#9200000000000000"), "241#9200000000000000");
  EXPECT_EQ(send("141#B400000000000000"), "none") << "500 kbit/s";
  EXPECT_EQ(send("141#9200000000000000"), "none");
  wait(2000 * kMs);
  EXPECT_EQ(send("141#9200000000000000"), "none");
}

TEST_F(MyactuatorNodeTest, AZeroIsOneAfterAReset) {
  turn(1.0);
  EXPECT_EQ(send("141#6400000000000000").substr(0, 6), "241#64");
  EXPECT_EQ(send("141#9200000000000000"), "241#9200000060160000");
  send("141#7600000000000000");
  wait(1100 * kMs);
  EXPECT_EQ(send("141#9200000000000000"), "241#9200000000000000");
  EXPECT_EQ(send(kNothing), kState);
}

TEST_F(MyactuatorNodeTest, InjectedFaults) {
  node_.inject(scenario_event_t::FAULT_SILENT, joint_, now_ + 10 * kMs);
  EXPECT_EQ(send(kRelease), "none");
  EXPECT_EQ(send(kCommand), "none");
  EXPECT_TRUE(node_.enabled()) << "it acts";
  wait(11 * kMs);
  node_.inject(scenario_event_t::FAULT_DROP_COMMANDS, joint_, now_ + 10 * kMs);
  EXPECT_EQ(send(kOff), "241#8000000000000000");
  EXPECT_TRUE(node_.enabled()) << "it answers";
  EXPECT_EQ(send(kStatus), "241#9A1E0001E0010000");
  wait(11 * kMs);
  node_.inject(scenario_event_t::FAULT_FROZEN_ENCODER, joint_, now_ + 10 * kMs);
  turn(1.0);
  joint_.theta_dot = joint_.v = 1.0;
  EXPECT_EQ(send(kNothing), kState);
  wait(11 * kMs);
  node_.inject(scenario_event_t::FAULT_HOT, joint_, now_ + 10 * kMs);
  EXPECT_EQ(send(kStatus).substr(0, 6), "241#9A");
}

}  // namespace
}  // namespace limber::sim::test_myactuator_node
