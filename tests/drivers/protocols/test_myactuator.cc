// Bytes of MyActuator's orders and motion mode against the manual's frames and others computed by
// hand.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "drivers/protocols/myactuator.h"
#include "tests/support/frame_text.h"

namespace limber::myactuator::test_myactuator {
namespace {

using limber::testing::parse;
using limber::testing::text;
using mit::Quantiser;

constexpr CommandRange kLegacy = {12.5, 45.0, 24.0, 500.0, 5.0};
constexpr CommandRange kX6 = {12.566, 45.0, 60.0, 500.0, 50.0};
constexpr mit::Command kCommand = {1.0, -2.0, 60.0, 1.5, 2.5};

std::string encoded(const mit::Command& command, const CommandRange& range, Quantiser quantiser) {
  CanFrame frame;
  EXPECT_TRUE(mit::encode_command(command, range, kMotionId + 1, false, quantiser, &frame));
  return text(frame);
}

TEST(Myactuator, AMotionCommandHasTheRangesOfItsFirmware) {
  EXPECT_EQ(encoded(kCommand, kLegacy, Quantiser::kTruncate), "401#8A3C7A41EB4CC8D4");
  EXPECT_EQ(encoded(kCommand, kX6, Quantiser::kTruncate), "401#8A2F7A41EB07A854");
  EXPECT_EQ(encoded(kCommand, kLegacy, Quantiser::kRound), "401#8A3D7A51EB4CD8D5");
  mit::Command read;
  ASSERT_TRUE(mit::decode_command(parse("401#8A3C7A41EB4CC8D4"), kX6, &read));
  EXPECT_NEAR(read.torque_Nm, 2.5 * 2.5, 0.03) << "by the other firmware's";
  EXPECT_NEAR(read.kd_Nms_per_rad, 15.0, 0.02);
}

// Of the manual: 10 rad, 1 rad/s, 10 N m/rad, 1 N m s/rad, 10 N m.
TEST(Myactuator, TheManualsMotionBothWays) {
  mit::Command command;
  ASSERT_TRUE(mit::decode_command(parse("401#E66682E052333B55"), kLegacy, &command));
  EXPECT_NEAR(command.position_rad, 10.0, 25.0 / 65535.0);
  EXPECT_NEAR(command.velocity_rad_per_s, 1.021, 1e-3);
  EXPECT_NEAR(command.kp_Nm_per_rad, 10.012, 1e-3);
  EXPECT_NEAR(command.kd_Nms_per_rad, 1.0, 1e-3);
  EXPECT_NEAR(command.torque_Nm, 10.004, 1e-3);
  Motion motion;
  ASSERT_TRUE(decode_motion(parse("501#01E66582EB550000"), kLegacy, &motion));
  EXPECT_EQ(motion.motor, 1);
  EXPECT_NEAR(motion.position_rad, 10.0, 1e-3);
  EXPECT_NEAR(motion.velocity_rad_per_s, 1.021, 1e-3);
  EXPECT_NEAR(motion.torque_Nm, 10.004, 1e-3);
  EXPECT_EQ(text(encode_motion({1, 10.0, 1.025, 10.006}, kLegacy, Quantiser::kTruncate)),
            "501#01E66582EB550000");
  EXPECT_EQ(text(encode_motion({32, 0.0, 0.0, 0.0}, kX6, Quantiser::kTruncate)),
            "520#207FFF7FF7FF0000");
  EXPECT_FALSE(decode_motion(parse("501#02E66582EB550000"), kLegacy, &motion)) << "another's";
  EXPECT_FALSE(decode_motion(parse("501#01E66582EB55"), kLegacy, &motion));
}

TEST(Myactuator, Orders) {
  EXPECT_EQ(text(order_frame(Order::kReleaseBrake, 1)), "141#7700000000000000");
  EXPECT_EQ(text(order_frame(Order::kLockBrake, 1)), "141#7800000000000000");
  EXPECT_EQ(text(order_frame(Order::kOff, 32)), "160#8000000000000000");
  EXPECT_EQ(text(order_frame(Order::kReset, 1)), "141#7600000000000000");
  EXPECT_EQ(text(order_frame(Order::kVersion, 1)), "141#B200000000000000");
  EXPECT_EQ(text(order_frame(Order::kTimeout, 1, 1000)), "141#B3000000E8030000") << "a second";
  EXPECT_EQ(text(function_frame(Function::kTellErrors, 1, 1)), "141#2003000001000000");
  EXPECT_EQ(text(function_frame(Function::kSetNumber, 1, 5)), "141#2005000005000000");
  EXPECT_EQ(text(model_frame(1, 2)), "141#B501020000000000");
  EXPECT_EQ(value_of(parse("241#B20000002E893401")), 20220206U);
  EXPECT_TRUE(answers(parse("241#B20000002E893401"), Order::kVersion, 1));
  EXPECT_FALSE(answers(parse("241#B20000002E893401"), Order::kVersion, 2));
  EXPECT_FALSE(answers(parse("141#B20000002E893401"), Order::kVersion, 1)) << "an order";
  EXPECT_FALSE(answers(parse("241#B20000002E8934"), Order::kVersion, 1));
  EXPECT_TRUE(only_reads(0x9A) && only_reads(0xB5) && only_reads(0x92));
  for (const int sets : {0x20, 0x31, 0x43, 0x63, 0x64, 0x76, 0x77, 0x80, 0xA1, 0xB3, 0xB4, 0xB6})
    EXPECT_FALSE(only_reads(static_cast<std::uint8_t>(sets))) << sets;
}

// Of the manual: 50 degC, 48.5 V, brake released, under-voltage; 360 degrees.
TEST(Myactuator, AStatusAndAnAngle) {
  const Status status = decode_status(parse("241#9A320001E5010400"));
  EXPECT_EQ(status.temperature_degC, 50);
  EXPECT_TRUE(status.brake_released);
  EXPECT_NEAR(status.supply_V, 48.5, 1e-9);
  EXPECT_EQ(errors_text(status.errors), "under-voltage");
  EXPECT_EQ(text(encode_status(status, 1)), "241#9A320001E5010400");
  EXPECT_EQ(text(encode_status({-5, false, 24.0, 0x1010}, 2)), "242#9AFB0000F0001010");
  EXPECT_EQ(errors_text(0x0016), "stall, under-voltage, over-current");
  EXPECT_EQ(errors_text(0x8800), "board too hot, another error");
  EXPECT_EQ(errors_text(0), "");
  EXPECT_NEAR(decode_angle(parse("241#92000000A08C0000")), 2.0 * std::numbers::pi, 1e-9);
  EXPECT_NEAR(decode_angle(parse("241#920000006073FFFF")), -2.0 * std::numbers::pi, 1e-9);
  EXPECT_EQ(text(encode_angle(2.0 * std::numbers::pi, 1)), "241#92000000A08C0000");
  EXPECT_EQ(text(encode_angle(-0.01, 1)), "241#92000000C7FFFFFF") << "-57 hundredths";
  EXPECT_EQ(text(encode_angle(std::nan(""), 1)), "241#9200000000000000");
  EXPECT_EQ(text(encode_angle(1e12, 1)), "241#92000000FFFFFF7F");
}

TEST(Myactuator, AModelComesInOneAnswerOrInBlocks) {
  ModelText one;
  one.add(parse("241#B558385332563130"));  // of the manual
  EXPECT_EQ(one.text(), "X8S2V10");
  EXPECT_EQ(one.series(), 8);
  ModelText two;
  two.add(parse("241#B50101524D442D58"));
  two.add(parse("241#B5010231322D5032"));
  EXPECT_EQ(two.text(), "RMD-X12-P2");
  EXPECT_EQ(two.series(), 12);
  for (int i = 0; i < 5; ++i) two.add(parse("241#B5FFFFFFFFFFFFFF"));
  EXPECT_EQ(two.text().size(), 14U);
  EXPECT_EQ(ModelText().series(), 0);
  ModelText none;
  none.add(parse("241#B550582D58585850"));
  EXPECT_EQ(none.series(), 0) << none.text();
}

TEST(Myactuator, TheFirmwareIsKnownByItsDate) {
  for (const std::uint32_t version : {20220206U, 20260423U, 2025070202U, 2026042401U})
    EXPECT_EQ(firmware_of(version), Firmware::kV42) << version;
  for (const std::uint32_t version : {2026042402U, 2026042403U, 2031010100U})
    EXPECT_EQ(firmware_of(version), Firmware::kV44) << version;
  for (const std::uint32_t version :
       {0U, 42U, 20260424U, 20270101U, 20221306U, 20220200U, 1926042402U, 0xFFFFFFFFU})
    EXPECT_EQ(firmware_of(version), Firmware::kUnknown) << version;
  EXPECT_EQ(firmware_of(kLegacy), Firmware::kV42);
  EXPECT_EQ(firmware_of(kX6), Firmware::kV44);
}

}  // namespace
}  // namespace limber::myactuator::test_myactuator
