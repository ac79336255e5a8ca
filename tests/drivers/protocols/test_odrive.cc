// Bytes of ODrive axes against worked frames, both ways; computed by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "drivers/protocols/odrive.h"
#include "tests/support/frame_text.h"

namespace limber::odrive::test_odrive {
namespace {

using limber::testing::parse;
using limber::testing::text;

// Node 2: 2 * 32 + message.
TEST(Odrive, CommandsHaveTheBytesOfTheManual) {
  EXPECT_EQ(text(encode(2, Message::kSetMode, kTorqueControl, kPassThrough)),
            "04B#0100000001000000");
  EXPECT_EQ(text(encode(2, Message::kSetState, kClosedLoop)), "047#08000000");
  // 0.2 = 1.6 / 8: exponent 7C, mantissa 4CCCCD
  EXPECT_EQ(text(encode(2, Message::kTorque, -0.2F)), "04E#CDCC4CBE");
  EXPECT_EQ(text(encode(2, Message::kClearErrors)), "058#");
  EXPECT_EQ(text(read_endpoint(2, 243)), "044#00F3000000000000");
  EXPECT_EQ(text(encode(2, Message::kWriteEndpoint, std::uint8_t{1}, std::uint16_t{243},
                        std::uint8_t{0}, 0.5F)),
            "044#01F300000000003F");
  const CanFrame asked = ask(2, Message::kTorques);
  EXPECT_EQ(text(asked), "05C#");
  EXPECT_TRUE(asked.remote && asks(asked));
  EXPECT_EQ(text(ask(kEverybody, Message::kAddress)), "7E6#");
  EXPECT_EQ(field<float>(parse("04E#CDCC4CBE"), 0), -0.2F);
  EXPECT_EQ(field<std::uint32_t>(parse("04B#0100000001000000"), 4), kPassThrough);
}

TEST(Odrive, WhatADriveTellsIsRead) {
  const CanFrame estimates = parse("049#87F9A23E0000C0BF");
  ASSERT_TRUE(is_message(estimates, 2, Message::kEstimates, 8));
  EXPECT_NEAR(field<float>(estimates, 0) * 2.0 * M_PI, 2.0, 1e-5);
  EXPECT_EQ(field<float>(estimates, 4), -1.5F);
  EXPECT_EQ(text(encode(2, Message::kEstimates, 0.31831F, -1.5F)), text(estimates));
  const CanFrame torques = parse("05C#CDCC4CBE000040BE");
  ASSERT_TRUE(is_message(torques, 2, Message::kTorques, 8));
  EXPECT_EQ(field<float>(torques, 0), -0.2F);
  EXPECT_EQ(field<float>(torques, 4), -0.1875F);
  EXPECT_EQ(text(encode(2, Message::kTorques, -0.2F, -0.1875F)), text(torques));
  const CanFrame heartbeat = parse("041#0000000008000100");
  ASSERT_TRUE(is_message(heartbeat, 2, Message::kHeartbeat, 7));
  EXPECT_EQ(heartbeat.data[4], kClosedLoop);
  const CanFrame expired = parse("041#0000000101030000");
  EXPECT_EQ(field<std::uint32_t>(expired, 0), kWatchdogExpired);
  EXPECT_EQ(expired.data[4], kIdle);
  EXPECT_EQ(expired.data[5], kDisarmed);
  EXPECT_EQ(error_text(kWatchdogExpired), "watchdog expired");
}

TEST(Odrive, AnEndpointIsReadInItsSize) {
  double value = 0.0;
  EXPECT_TRUE(decode_endpoint(parse("045#00F300000000003F"), 2, 243, 4, true, &value));
  EXPECT_EQ(value, 0.5);
  EXPECT_TRUE(decode_endpoint(parse("045#0013010010270000"), 2, 275, 4, false, &value));
  EXPECT_EQ(value, 10000.0);
  EXPECT_TRUE(decode_endpoint(parse("045#00F4000001"), 2, 244, 1, false, &value));
  EXPECT_EQ(value, 1.0);
  EXPECT_FALSE(decode_endpoint(parse("045#00F4000001"), 2, 243, 1, false, &value)) << "another";
  EXPECT_FALSE(decode_endpoint(parse("045#00F3000000"), 2, 243, 4, true, &value)) << "too short";
  EXPECT_FALSE(decode_endpoint(parse("065#00F4000001"), 2, 244, 1, false, &value)) << "node 3";
}

TEST(Odrive, OtherFramesAreNoMessages) {
  CanFrame frame = parse("049#87F9A23E0000C0BF");
  EXPECT_FALSE(is_message(frame, 3, Message::kEstimates, 8));
  EXPECT_FALSE(is_message(frame, 2, Message::kTorques, 8));
  EXPECT_FALSE(is_message(parse("049#87F9A23E"), 2, Message::kEstimates, 8));
  frame.remote = true;
  EXPECT_FALSE(is_message(frame, 2, Message::kEstimates, 8));
  frame.remote = false;
  frame.extended = true;
  EXPECT_FALSE(is_message(frame, 2, Message::kEstimates, 8));
  frame.extended = false;
  frame.error = true;
  EXPECT_FALSE(is_message(frame, 2, Message::kEstimates, 8));
  EXPECT_EQ(layout_of(0x5F), nullptr) << "1F, starting the update of the firmware";
  EXPECT_TRUE(asks(parse("049#")));
  EXPECT_FALSE(asks(parse("049#00")));
}

TEST(Odrive, BitsAndStatesInWords) {
  EXPECT_EQ(error_text(0), "");
  EXPECT_EQ(error_text(1), "initialising");
  EXPECT_EQ(error_text(kOverCurrent), "over-current");
  EXPECT_EQ(error_text(kEstopped), "emergency stop");
  EXPECT_EQ(error_text(1U << 30U), "calibration");
  EXPECT_EQ(error_text(1U << 31U), "error bit 31");
  EXPECT_EQ(error_text(1U << 7U), "error bit 7");
  EXPECT_EQ(state_text(1), "idle");
  EXPECT_EQ(state_text(8), "closed loop");
  EXPECT_EQ(state_text(11), "homing");
  EXPECT_EQ(state_text(5), "state 5");
  EXPECT_EQ(state_text(99), "state 99");
}

}  // namespace
}  // namespace limber::odrive::test_odrive
