// The emulated RobStride drive, byte by byte where bytes matter.
#include <gtest/gtest.h>

#include <cmath>
#include <limber/scenario_event_t.hpp>
#include <numbers>
#include <string>

#include "robots/loader/protocols/drive_protocol.h"
#include "sim/nodes/robstride_node.h"
#include "tests/sim/test_arms.h"
#include "tests/support/frame_text.h"

namespace limber::sim::test_robstride_node {
namespace {

using robstride::Mode;

constexpr std::int64_t kMs = 1'000'000;
constexpr double kTwoTurns = 4.0 * std::numbers::pi;
const std::string kEnable = "0300FD01#0000000000000000";
const std::string kStop = "0400FD01#0000000000000000";
const std::string kClear = "0400FD01#0100000000000000";
const std::string kNothing = "017FFF01#7FFF7FFF00000000";

/// Motor 1: an RS02 that lets go by itself, not damped.
JointConfig motor1() {
  JointConfig joint = testing::joint_config(0, JointType::kRevolute, 0.0);
  joint.drive.protocol = &protocol_named("robstride");
  joint.drive.command_id = 0x01000001;
  joint.drive.reply_id = 0x020001FD;
  joint.drive.range = {kTwoTurns, 44.0, 17.0, 500.0, 5.0};
  joint.drive.watchdog_reaction = NodeWatchdogReaction::kOff;
  return joint;
}

class RobstrideNodeTest : public ::testing::Test {
 protected:
  /// The answer, "28001FD#...", or "none".
  std::string send(const std::string& candump) {
    CanFrame frame = limber::testing::parse(candump);
    frame.extended = true;
    if (!node_.receive(frame, joint_, now_, &reply_)) return "none";
    EXPECT_TRUE(reply_.extended);
    return limber::testing::text(reply_);
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

  RobstrideNode node_{motor1()};
  JointReading joint_;
  std::int64_t now_ = 0;
  CanFrame reply_;
};

TEST_F(RobstrideNodeTest, AStateBeforeTheFrameTakesEffect) {
  EXPECT_EQ(send(kEnable), "20001FD#7FFF7FFF7FFF012C") << "30 degC";
  EXPECT_EQ(send(kNothing), "28001FD#7FFF7FFF7FFF012C");
  EXPECT_EQ(send("0300AA01#0000000000000000").substr(0, 8), "28001AA#") << "to who spoke";
  EXPECT_EQ(send("0300FD02#0000000000000000"), "none") << "another motor";
  EXPECT_EQ(send("028001FD#7FFF7FFF7FFF012C"), "none") << "a state";
}

TEST_F(RobstrideNodeTest, TheCommandIsObeyedWhileItRuns) {
  const std::string command = "0192D201#8A2F7A2E1EB86666";  // 1 rad, -2 rad/s, 60, 2, 2.5 N m
  send(command);
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0) << "stopped";
  send(kEnable);
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0) << "no command yet";
  send(command);
  EXPECT_NEAR(node_.law().torque(0.95, -1.9), 60.0 * 0.05 + 2.0 * -0.1 + 2.5, 0.03);
  EXPECT_EQ(node_.law().torque(-100.0, 0.0), 7.0) << "its peak";
  send(kStop);
  EXPECT_EQ(node_.law().torque(0.95, 0.0), 0.0);
  EXPECT_FALSE(node_.enabled());
}

TEST_F(RobstrideNodeTest, TheWatchdogIsOffWhenItIsDeliveredAndLetsGoWithoutAFault) {
  send(kEnable);
  wait(1000 * kMs);
  EXPECT_TRUE(node_.enabled());
  EXPECT_EQ(send("1100FD01#2870000000000000"), "110001FD#2870000000000000");
  send("1200FD01#2870000090010000");  // 20 ms
  EXPECT_EQ(send("1100FD01#2870000000000000"), "110001FD#2870000090010000");
  send(kNothing);
  wait(20 * kMs);
  EXPECT_TRUE(node_.enabled());
  wait(kMs);
  EXPECT_FALSE(node_.enabled());
  EXPECT_EQ(send(kNothing), "20001FD#7FFF7FFF7FFF012C") << "no fault to be seen";
}

TEST_F(RobstrideNodeTest, TheRunModeChangesWhileItIsStopped) {
  send("1200FD01#0570000002000000");
  EXPECT_EQ(send("1100FD01#0570000000000000"), "110001FD#0570000002000000");
  send(kEnable);
  send("0192D201#8A2F7A2E1EB86666");
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0) << "not the mode of the five numbers";
  EXPECT_EQ(send("1200FD01#0570000000000000").substr(0, 8), "28001FD#") << "answered the same";
  EXPECT_EQ(send("1100FD01#0570000000000000"), "110001FD#0570000002000000") << "running";
  send(kStop);
  send("1200FD01#0570000009000000");
  EXPECT_EQ(send("1100FD01#0570000000000000"), "110001FD#0570000002000000") << "there is no 9";
}

TEST_F(RobstrideNodeTest, WhatTheFirmwareLacksReadsZeroWithAFlag) {
  EXPECT_EQ(send("1100FD01#FF70000000000000"), "110101FD#FF70000000000000");
  EXPECT_EQ(send("1100FD01#1C70000000000000"), "110001FD#1C70000000004042") << "48 V";
}

TEST_F(RobstrideNodeTest, AFaultIsToldOnceAndKeptInTheState) {
  send(kEnable);
  node_.inject(scenario_event_t::FAULT_DRIVE_ERROR, joint_, now_ + 10 * kMs);
  EXPECT_FALSE(node_.enabled());
  EXPECT_EQ(unasked(), "150001FD#0000010000000000");
  EXPECT_EQ(unasked(), "none");
  EXPECT_EQ(send(kClear).substr(0, 8), "20201FD#");
  EXPECT_EQ(send(kEnable).substr(0, 8), "20201FD#") << "not while it lasts";
  wait(11 * kMs);
  send(kEnable);
  EXPECT_FALSE(node_.enabled()) << "not before it is cleared";
  send(kClear);
  send(kEnable);
  EXPECT_TRUE(node_.enabled());
}

TEST_F(RobstrideNodeTest, ReportsComeUnaskedOnceSwitchedOn) {
  wait(50 * kMs);
  EXPECT_EQ(unasked(), "none");
  send("1800FD01#0102030405060100");
  wait(9 * kMs);
  EXPECT_EQ(unasked(), "none");
  wait(kMs);
  EXPECT_EQ(unasked(), "180001FD#7FFF7FFF7FFF012C");
  EXPECT_EQ(unasked(), "none");
  send("1200FD01#2670000003000000");  // 20 ms
  wait(19 * kMs);
  EXPECT_EQ(unasked(), "none");
  wait(kMs);
  EXPECT_EQ(unasked(), "180001FD#7FFF7FFF7FFF012C");
  send("1800FD01#0102030405060000");
  wait(100 * kMs);
  EXPECT_EQ(unasked(), "none");
}

TEST_F(RobstrideNodeTest, ABitRateIsAnsweredAndWaitsForThePower) {
  EXPECT_EQ(send("1700FD01#0102030405060200"), "1FE#0100000000000000");
  EXPECT_EQ(send("0000FD01#0000000000000000"), "1FE#0100000000000000");
}

TEST_F(RobstrideNodeTest, ZeroAndNumber) {
  joint_.theta = joint_.q = 1.0;
  EXPECT_EQ(send(kNothing).substr(8, 4), "8A2D") << "2607 of 16384 counts";
  send("0600FD01#0100000000000000");
  EXPECT_EQ(send(kNothing).substr(8, 4), "7FFF");
  send(kEnable);
  joint_.theta = joint_.q = 2.0;
  send("0600FD01#0100000000000000");
  EXPECT_NE(send(kNothing).substr(8, 4), "7FFF") << "stop first";
  EXPECT_EQ(send("0705FD01#0000000000000000").substr(0, 6), "5FE#05") << "at once";
  EXPECT_EQ(send(kNothing), "none");
  EXPECT_EQ(send("0000FD05#0000000000000000").substr(0, 4), "5FE#");
}

TEST_F(RobstrideNodeTest, InjectedFaults) {
  node_.inject(scenario_event_t::FAULT_SILENT, joint_, now_ + 10 * kMs);
  EXPECT_EQ(send(kEnable), "none");
  EXPECT_TRUE(node_.enabled()) << "it acts";
  wait(11 * kMs);
  node_.inject(scenario_event_t::FAULT_DROP_COMMANDS, joint_, now_ + 10 * kMs);
  EXPECT_EQ(send(kStop).substr(0, 8), "28001FD#");
  EXPECT_TRUE(node_.enabled()) << "it answers";
  wait(11 * kMs);
  node_.inject(scenario_event_t::FAULT_FROZEN_ENCODER, joint_, now_ + 10 * kMs);
  joint_.theta = joint_.q = 1.0;
  joint_.theta_dot = joint_.v = 1.0;
  EXPECT_EQ(send(kNothing).substr(8, 8), "7FFF7FFF");
}

}  // namespace
}  // namespace limber::sim::test_robstride_node
