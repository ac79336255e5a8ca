// Bytes of CubeMars drives against worked frames, both ways; counts computed by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "drivers/protocols/cubemars.h"
#include "tests/support/frame_text.h"

namespace limber::cubemars::test_cubemars {
namespace {

using limber::testing::text;
using mit::Quantiser;

CanFrame parse(const std::string& candump) {
  CanFrame frame = limber::testing::parse(candump);
  frame.extended = candump.find('#') > 3;
  return frame;
}

/// Motor 2 with V1 or V2, an AK80-9.
DriveConfig ak80_9(int board) {
  DriveConfig drive;
  drive.board = board;
  drive.command_id = 2;
  drive.reply_id = 0;
  drive.range = {12.5, 50.0, 18.0, 500.0, 5.0};
  return drive;
}

/// Motor 0x68 with V3, an AK10-9 of 21 pole pairs and 2 N m/A behind its gear.
DriveConfig ak10_9() {
  DriveConfig drive;
  drive.board = kV3;
  drive.command_id = 0x868;
  drive.reply_id = 0x2968;
  drive.range = {12.56, 28.0, 54.0, 500.0, 5.0};
  drive.gear_ratio = 9.0;
  drive.torque_constant_Nm_per_A = 2.0;
  return drive;
}

std::string encoded(const mit::Command& command, const DriveConfig& drive) {
  CanFrame frame;
  EXPECT_TRUE(mit::encode_command(command, drive.range, drive.command_id, false,
                                  Quantiser::kTruncate, &frame));
  if (drive.board == kV3) frame = gains_first(frame);
  return (frame.extended ? "0000" : "") + text(frame);
}

void expect_command(const std::string& candump, const DriveConfig& drive,
                    const mit::Command& expected) {
  mit::Command read;
  ASSERT_TRUE(decode_command(parse(candump), drive, &read)) << candump;
  EXPECT_NEAR(read.position_rad, expected.position_rad, 2.0 * drive.range.position_rad / 65535.0);
  EXPECT_NEAR(read.velocity_rad_per_s, expected.velocity_rad_per_s,
              2.0 * drive.range.velocity_rad_per_s / 4095.0);
  EXPECT_NEAR(read.kp_Nm_per_rad, expected.kp_Nm_per_rad, 500.0 / 4095.0);
  EXPECT_NEAR(read.kd_Nms_per_rad, expected.kd_Nms_per_rad, 5.0 / 4095.0);
  EXPECT_NEAR(read.torque_Nm, expected.torque_Nm, 2.0 * drive.range.torque_Nm / 4095.0);
}

// 30670, 2170, 204, 655 and 1569 counts.
TEST(Cubemars, ACommandToBoardsV1AndV2) {
  const mit::Command command{-0.8, 3.0, 25.0, 0.8, -4.2};
  EXPECT_EQ(encoded(command, ak80_9(kV2)), "002#77CE87A0CC28F621");
  expect_command("002#77CE87A0CC28F621", ak80_9(kV1), command);
  mit::Command read;
  EXPECT_FALSE(decode_command(parse("003#77CE87A0CC28F621"), ak80_9(kV2), &read)) << "another's";
  EXPECT_FALSE(decode_command(parse("002#77CE87A0CC28F6"), ak80_9(kV2), &read));
  EXPECT_FALSE(decode_command(parse("002#FFFFFFFFFFFFFFFC"), ak80_9(kV2), &read)) << "special";
}

// kp 491, kd 1228, p 35376, v 1901, t 2142 counts.
TEST(Cubemars, ACommandToABoardV3HasItsGainsFirst) {
  const mit::Command command{1.0, -2.0, 60.0, 1.5, 2.5};
  EXPECT_EQ(encoded(command, ak10_9()), "0000868#1EB4CC8A3076D85E");
  expect_command("00000868#1EB4CC8A3076D85E", ak10_9(), command);
  mit::Command read;
  EXPECT_FALSE(decode_command(parse("868#1EB4CC8A3076D85E"), ak10_9(), &read)) << "of 11 bits";
}

TEST(Cubemars, NoCommandBeginsWithSixBytesFF) {
  const mit::Command most{100.0, 100.0, 1000.0, 100.0, 100.0};
  EXPECT_EQ(encoded(most, ak80_9(kV2)), "002#FFFFFFFFFFFEFFFF");
  EXPECT_EQ(encoded(most, ak10_9()), "0000868#FFFFEFFFFFFFFFFF") << "moved down as in mit.h";
  // A velocity of FF0 counts lets the MIT order pass, whose sixth byte it shares.
  EXPECT_EQ(encoded({100.0, 27.8, 1000.0, 100.0, 0.0}, ak10_9()), "0000868#FFFFFEFFFFFF07FF");
}

TEST(Cubemars, SwitchingOnAndOff) {
  EXPECT_EQ(text(on_frame(ak80_9(kV1))), "002#FFFFFFFFFFFFFFFC");
  EXPECT_EQ(text(on_frame(ak10_9())), "868#0000007FFF800800") << "neither gains nor torque";
  EXPECT_EQ(text(off_frame(ak80_9(kV1))), "002#FFFFFFFFFFFFFFFD");
  const CanFrame off = off_frame(ak10_9());
  EXPECT_EQ(text(off), "168#00000000") << "no current";
  EXPECT_TRUE(off.extended);
}

TEST(Cubemars, AStateOfV2AndTheSameOfV1) {
  const DriveConfig v2 = ak80_9(kV2);
  State state;
  ASSERT_TRUE(decode_state(parse("000#0277CE87A6212400"), v2, &state));
  EXPECT_NEAR(state.position_rad, -0.8, 25.0 / 65535.0);
  EXPECT_NEAR(state.velocity_rad_per_s, 3.0, 100.0 / 4095.0);
  EXPECT_NEAR(state.torque_Nm, -4.2, 36.0 / 4095.0);
  EXPECT_EQ(state.temperature_degC, 36);
  EXPECT_EQ(state.error, 0);
  const State measured{-0.8, 3.0, -4.2, 36, 0};
  EXPECT_EQ(text(encode_state(measured, v2, Quantiser::kTruncate)), "000#0277CE87A6212400");
  EXPECT_EQ(text(encode_state(measured, ak80_9(kV1), Quantiser::kTruncate)), "000#0277CE87A621");
  ASSERT_TRUE(decode_state(parse("000#0277CE87A621"), ak80_9(kV1), &state));
  EXPECT_NEAR(state.torque_Nm, -4.2, 36.0 / 4095.0);
  EXPECT_EQ(state.temperature_degC, 0) << "not told";
  ASSERT_TRUE(decode_state(parse("000#0277CE87A621FA04"), v2, &state));
  EXPECT_EQ(state.temperature_degC, -6);
  EXPECT_STREQ(error_text(state.error, kV2), "under-voltage");
}

TEST(Cubemars, TheFirstByteTellsWhoseAStateIs) {
  State state;
  EXPECT_FALSE(decode_state(parse("000#0377CE87A6212400"), ak80_9(kV2), &state));
  EXPECT_FALSE(decode_state(parse("001#0277CE87A6212400"), ak80_9(kV2), &state));
  EXPECT_FALSE(decode_state(parse("000#0277CE87A621"), ak80_9(kV2), &state)) << "of a V1";
  EXPECT_FALSE(decode_state(parse("000#0277CE87A6212400"), ak80_9(kV1), &state)) << "of a V2";
  EXPECT_TRUE(is_from(parse("000#0277CE87A621"), ak80_9(kV2)));
  EXPECT_TRUE(is_servo_state(parse("00002902#0000000000000000"), ak80_9(kV2)));
  EXPECT_TRUE(is_from(parse("00002902#0000000000000000"), ak80_9(kV2)));
  EXPECT_FALSE(decode_state(parse("00002902#0277CE87A6212400"), ak80_9(kV2), &state));
  EXPECT_FALSE(is_servo_state(parse("00002903#0000000000000000"), ak80_9(kV2)));
}

// 90.0 degrees, -1000 rpm of 21 pole pairs behind a gear of 9, 1.5 A of 2 N m/A, 31 degC, stalled.
TEST(Cubemars, AStateOfV3) {
  const double speed = -1000.0 * 2.0 * std::numbers::pi / 60.0 / (21.0 * 9.0);
  State state;
  ASSERT_TRUE(decode_state(parse("00002968#0384FF9C00961F07"), ak10_9(), &state));
  EXPECT_NEAR(state.position_rad, std::numbers::pi / 2.0, 1e-12);
  EXPECT_NEAR(state.velocity_rad_per_s, speed, 1e-12);
  EXPECT_NEAR(state.torque_Nm, 3.0, 1e-12);
  EXPECT_EQ(state.temperature_degC, 31);
  EXPECT_STREQ(error_text(state.error, kV3), "stalled");
  const State measured{std::numbers::pi / 2.0 + 1e-6, 1.0001 * speed, 3.0001, 31, 7};
  EXPECT_EQ(text(encode_state(measured, ak10_9(), Quantiser::kTruncate)), "2968#0384FF9C00961F07");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(text(encode_state({1e9, -1e9, nan}, ak10_9(), Quantiser::kTruncate)),
            "2968#7FFF800080000000");
}

TEST(Cubemars, ErrorsThatNoSourceListsHaveNoText) {
  EXPECT_STREQ(error_text(0, kV2), "");
  EXPECT_STREQ(error_text(6, kV2), "phases unbalanced");
  EXPECT_STREQ(error_text(7, kV2), "");
  EXPECT_STREQ(error_text(6, kV3), "power stage too hot");
  EXPECT_STREQ(error_text(255, kV3), "");
}

}  // namespace
}  // namespace limber::cubemars::test_cubemars
