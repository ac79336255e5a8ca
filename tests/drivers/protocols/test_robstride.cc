// Bytes of RobStride's private protocol against frames computed by hand from its manuals.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "drivers/protocols/robstride.h"
#include "tests/support/frame_text.h"

namespace limber::robstride::test_robstride {
namespace {

using limber::testing::text;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTwoTurns = 4.0 * std::numbers::pi;
constexpr CommandRange kRs02 = {kTwoTurns, 44.0, 17.0, 500.0, 5.0};
constexpr CommandRange kRs04 = {kTwoTurns, 15.0, 120.0, 5000.0, 100.0};
constexpr Command kCommand = {1.0, -2.0, 60.0, 2.0, 2.5};

CanFrame parse(const std::string& candump) {
  CanFrame frame = limber::testing::parse(candump);
  frame.extended = true;
  return frame;
}

std::string encoded(const Command& command, const CommandRange& range, std::uint8_t motor) {
  CanFrame frame;
  EXPECT_TRUE(encode_command(command, range, motor, &frame));
  EXPECT_TRUE(frame.extended);
  return text(frame);
}

TEST(Robstride, ACommandIsRounded) {
  EXPECT_EQ(encoded(kCommand, kRs02, 1), "192D201#8A2F7A2E1EB86666");
  EXPECT_EQ(encoded({}, kRs02, 1), "17FFF01#7FFF7FFF00000000") << "zero is a count";
  EXPECT_EQ(encoded({100.0, 100.0, 1e4, 1e4, 100.0}, kRs02, 0x7F), "1FFFE7F#FFFEFFFEFFFFFFFF");
  EXPECT_EQ(encoded({-100.0, -100.0, -1.0, -1.0, -100.0}, kRs02, 1), "1000001#0000000000000000");
}

TEST(Robstride, ACommandMeansWhatTheModelsRangesSay) {
  CanFrame frame;
  ASSERT_TRUE(encode_command(kCommand, kRs04, 2, &frame));
  Command read;
  ASSERT_TRUE(robstride::decode_command(frame, kRs04, &read));
  EXPECT_NEAR(read.torque_Nm, 2.5, 0.5 * 120.0 / 32767.0);
  EXPECT_NEAR(read.position_rad, 1.0, 0.5 * kTwoTurns / 32767.0);
  EXPECT_NEAR(read.velocity_rad_per_s, -2.0, 0.5 * 15.0 / 32767.0);
  EXPECT_NEAR(read.kp_Nm_per_rad, 60.0, 0.5 * 5000.0 / 65535.0);
  EXPECT_NEAR(read.kd_Nms_per_rad, 2.0, 0.5 * 100.0 / 65535.0);
  ASSERT_TRUE(robstride::decode_command(frame, kRs02, &read));
  EXPECT_NEAR(read.torque_Nm, 2.5 * 17.0 / 120.0, 0.01) << "by another model's";
  EXPECT_DOUBLE_EQ(torque_count_Nm(kRs02), 17.0 / 32767.0);
}

TEST(Robstride, WhatIsNotFiniteIsNoCommand) {
  CanFrame frame;
  for (double Command::*member :
       {&Command::position_rad, &Command::velocity_rad_per_s, &Command::kp_Nm_per_rad,
        &Command::kd_Nms_per_rad, &Command::torque_Nm}) {
    for (const double value : {kNan, HUGE_VAL, -HUGE_VAL}) {
      Command command = kCommand;
      command.*member = value;
      EXPECT_FALSE(encode_command(command, kRs02, 1, &frame));
    }
  }
  for (double CommandRange::*member :
       {&CommandRange::position_rad, &CommandRange::velocity_rad_per_s, &CommandRange::torque_Nm,
        &CommandRange::kp_Nm_per_rad, &CommandRange::kd_Nms_per_rad}) {
    for (const double value : {0.0, -1.0, kNan, HUGE_VAL}) {
      CommandRange range = kRs02;
      range.*member = value;
      EXPECT_FALSE(encode_command(kCommand, range, 1, &frame));
    }
  }
  EXPECT_EQ(frame.length, 0) << "left alone";
}

TEST(Robstride, AState) {
  State state;
  state.motor = 1;
  state.mode = Mode::kRun;
  state.position_rad = 0.75;
  state.velocity_rad_per_s = -0.5;
  state.torque_Nm = 1.8;
  state.temperature_degC = 38.5;
  const CanFrame frame = encode_state(state, kRs02, Type::kState);
  EXPECT_EQ(text(frame), "28001FD#87A27E8A8D8C0181");
  state.faults = kOverCurrent | kOverTemperature;
  state.mode = Mode::kReset;
  EXPECT_EQ(text(encode_state(state, kRs02, Type::kReport)).substr(0, 9), "180601FD#");
  State read;
  ASSERT_TRUE(decode_state(parse("028001FD#87A37E8B8D8C0181"), kRs02, &read));
  EXPECT_EQ(read.motor, 1);
  EXPECT_EQ(read.host, 0xFD);
  EXPECT_EQ(read.mode, Mode::kRun);
  EXPECT_EQ(read.faults, 0);
  EXPECT_NEAR(read.position_rad, 0.75, kTwoTurns / 32767.0);
  EXPECT_NEAR(read.velocity_rad_per_s, -0.5, 44.0 / 32767.0);
  EXPECT_NEAR(read.torque_Nm, 1.8, 17.0 / 32767.0);
  EXPECT_NEAR(read.temperature_degC, 38.5, 1e-9);
  ASSERT_TRUE(decode_state(parse("183F01FD#7FFF7FFF7FFF0000"), kRs02, &read));
  EXPECT_EQ(read.faults, 0x3F);
  EXPECT_EQ(read.position_rad, 0.0);
}

TEST(Robstride, RequestsAreWhoseFramesTheyAre) {
  EXPECT_EQ(text(request(Type::kEnable, 1)), "300FD01#0000000000000000");
  EXPECT_EQ(text(request(Type::kStop, 0x7F)), "400FD7F#0000000000000000");
  EXPECT_EQ(text(encode_write(1, static_cast<std::uint16_t>(Parameter::kTimeout), 400)),
            "1200FD01#2870000090010000")
      << "20 ms";
  EXPECT_EQ(text(encode_read(2, 0x701B)), "1100FD02#1B70000000000000");
}

TEST(Robstride, AParameterMayBeRefused) {
  ParameterRequest request;
  ASSERT_TRUE(decode_parameter_request(parse("1200FD01#2870000090010000"), &request));
  EXPECT_TRUE(request.write);
  EXPECT_EQ(request.index, 0x7028);
  EXPECT_EQ(request.raw, 400U);
  ASSERT_TRUE(decode_parameter_request(parse("1100FD01#2870000000000000"), &request));
  EXPECT_FALSE(request.write);
  EXPECT_EQ(text(encode_parameter_answer({1, 0xFD, false, 0x7028, 400})),
            "110001FD#2870000090010000");
  EXPECT_EQ(text(encode_parameter_answer({1, 0xFD, true, 0x7028, 400})),
            "110101FD#2870000000000000")
      << "a flag, and the value is 0";
  ParameterAnswer answer;
  ASSERT_TRUE(decode_parameter_answer(parse("110101FD#2870000000000000"), &answer));
  EXPECT_TRUE(answer.refused);
  EXPECT_EQ(answer.motor, 1);
  EXPECT_FALSE(decode_parameter_answer(parse("1100FD01#2870000000000000"), &answer))
      << "a request to a motor";
}

TEST(Robstride, AFaultFrame) {
  EXPECT_EQ(text(encode_fault(3, 0xFD, {0x10081, 2})), "150003FD#8100010002000000");
  FaultReport report;
  ASSERT_TRUE(decode_fault(parse("150003FD#8100010002000000"), &report));
  EXPECT_EQ(report.faults, 0x10081U);
  EXPECT_EQ(report.warnings, 2U);
  EXPECT_STREQ(reported_fault_text(7), "encoder not calibrated");
  EXPECT_STREQ(reported_fault_text(31), "");
  EXPECT_STREQ(fault_text(1), "over-current");
}

TEST(Robstride, OtherFramesAreNone) {
  Id id{};
  CanFrame frame = parse("028001FD#87A37E8B8D8C0181");
  EXPECT_TRUE(split(frame, &id));
  for (const auto& spoil :
       {+[](CanFrame* one) { one->extended = false; }, +[](CanFrame* one) { one->remote = true; },
        +[](CanFrame* one) { one->error = true; }, +[](CanFrame* one) { one->fd = true; },
        +[](CanFrame* one) { one->length = 7; }}) {
    CanFrame other = frame;
    spoil(&other);
    State state;
    EXPECT_FALSE(split(other, &id));
    EXPECT_FALSE(decode_state(other, kRs02, &state));
  }
}

}  // namespace
}  // namespace limber::robstride::test_robstride
