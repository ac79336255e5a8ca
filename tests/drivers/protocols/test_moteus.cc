// Bytes of the moteus register protocol against frames composed by hand from its reference, and its
// algebra over formats and boundaries.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "drivers/protocols/moteus.h"
#include "drivers/protocols/moteus_frame.h"
#include "tests/support/frame_text.h"
#include "tools/allocations/allocations.h"

namespace limber::moteus::test_moteus {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::array kTypes = {Type::kInt8, Type::kInt16, Type::kInt32, Type::kFloat};

using limber::testing::text;

CanFrame parse(const std::string& candump) {
  CanFrame frame = limber::testing::parse(candump);
  frame.fd = true;
  return frame;
}

std::uint16_t number(Register reg) { return static_cast<std::uint16_t>(reg); }

/// All values of the replies in a frame, register by register: "0=10 1=0.1".
std::string told(const CanFrame& frame) {
  FrameReader reader(frame);
  Subframe subframe;
  std::string all;
  while (reader.next(&subframe)) {
    for (unsigned i = 0; i < subframe.count && subframe.data != nullptr; ++i) {
      std::array<char, 40> part{};
      std::snprintf(part.data(), part.size(), "%s%x=%g", all.empty() ? "" : " ", subframe.first + i,
                    subframe.value(i));
      all += part.data();
    }
  }
  return all + (reader.malformed() ? " malformed" : "");
}

// --- identifiers ---

TEST(MoteusId, CommandsAreLongAnswersShortUpToServo7) {
  EXPECT_EQ(command_id(4), 0x8004U);
  EXPECT_EQ(reply_id(4), 0x0400U);
  EXPECT_EQ(reply_id(7), 0x0700U);
  EXPECT_EQ(reply_id(8), 0x0800U);
  EXPECT_TRUE(encode_stop(command_id(1)).extended);
  EXPECT_FALSE(FrameWriter(reply_id(7)).frame().extended);
  EXPECT_TRUE(FrameWriter(reply_id(8)).frame().extended);
}

TEST(MoteusId, AddressAndIdentifierAreOneToOne) {
  for (unsigned source : {0U, 1U, 0x7FU}) {
    for (unsigned destination : {0U, 1U, 0x7FU}) {
      for (bool wanted : {false, true}) {
        for (unsigned prefix : {0U, 1U, 0x1FFFU}) {
          const std::uint32_t id =
              can_id({static_cast<std::uint8_t>(source), static_cast<std::uint8_t>(destination),
                      wanted, static_cast<std::uint16_t>(prefix)});
          EXPECT_EQ(id, prefix * 65536 + (wanted ? 32768U : 0U) + source * 256 + destination);
          EXPECT_LE(id, kExtendedIdMax);
          const Address back = address_of(id);
          EXPECT_EQ(back.source, source);
          EXPECT_EQ(back.destination, destination);
          EXPECT_EQ(back.reply_wanted, wanted);
          EXPECT_EQ(back.prefix, prefix);
        }
      }
    }
  }
}

// --- worked frames ---

TEST(MoteusFrames, StopAndQuery) {
  FrameWriter frame(command_id(4));
  const double stopped = 0.0;
  EXPECT_TRUE(frame.write(Type::kInt8, Register::kMode, std::span(&stopped, 1)));
  EXPECT_TRUE(frame.read(Type::kInt8, number(Register::kMode), 1));
  EXPECT_TRUE(frame.read(Type::kFloat, number(Register::kPosition), 3));
  EXPECT_TRUE(frame.read(Type::kInt8, number(Register::kVoltage), 3));
  EXPECT_EQ(text(frame.frame()),
            "8004#0100001100"
            "1F01130D505050");
}

TEST(MoteusFrames, PositionInFloat) {
  FrameWriter frame(command_id(4));
  const double mode = 10.0;
  const std::array command = {0.1, 0.0, 0.85, 0.2, 0.1};
  const double watchdog = 0.02;
  frame.write(Type::kInt8, Register::kMode, std::span(&mode, 1));
  frame.write(Type::kFloat, Register::kCommandPosition, command);
  frame.write(Type::kFloat, Register::kCommandWatchdog, std::span(&watchdog, 1));
  frame.read(Type::kInt8, 0x00, 1);
  frame.read(Type::kFloat, 0x01, 3);
  frame.read(Type::kInt8, 0x0D, 3);
  const CanFrame done = frame.frame();
  EXPECT_EQ(done.length, 48);
  EXPECT_TRUE(done.fd && done.bitrate_switch && done.extended);
  EXPECT_EQ(text(done),
            "8004#01000A0C0520CDCCCC3D000000009A99593FCDCC4C3ECDCCCC3D0D270AD7A33C11001F01130D"
            "50505050505050505050");
}

TEST(MoteusFrames, TorqueInInt16) {
  FrameWriter frame(command_id(4));
  const double mode = 10.0;
  const std::array command = {kNan, 0.0, 0.85, 0.0, 0.0, 2.0};
  frame.write(Type::kInt8, Register::kMode, std::span(&mode, 1));
  frame.write(Type::kInt16, Register::kCommandPosition, command);
  frame.read(Type::kInt16, 0x00, 4);
  frame.read(Type::kInt8, 0x0D, 3);
  EXPECT_EQ(text(frame.frame()),
            "8004#01000A0406200080000055000000"
            "0000C800140400130D50");
}

TEST(MoteusFrames, AnswersInInt16) {
  EXPECT_EQ(told(parse("400#2404000A00E8039CFF5500230D601E00")),
            "0=10 1=0.1 2=-0.025 3=0.85 d=48 e=30 f=0");
  EXPECT_EQ(told(parse("400#2404000B00E80300000000230D601E00")),
            "0=11 1=0.1 2=0 3=0 d=48 e=30 f=0");
  EXPECT_EQ(told(parse("400#210001210F25")), "0=1 f=37");
}

// --- what limber says and hears ---

TEST(MoteusMessages, CommandByteByByte) {
  Command command;
  command.position_turns = kNan;
  command.torque_Nm = 0.85;
  command.max_torque_Nm = 2.0;
  command.watchdog_s = 0.02;
  const CanFrame frame = encode_command(command, command_id(4));
  EXPECT_EQ(frame.length, 48);
  EXPECT_EQ(text(frame),
            "8004#01000A"                                             // position mode
            "0C06200000C07F000000009A99593F000000000000000000000040"  // six floats from 0x020
            "0D270AD7A33C"                                            // watchdog
            "11001C0401120E"                                          // what is asked
            "5050505050");
  EXPECT_EQ(text(encode_stop(command_id(4))), "8004#01000011001C0401120E5050");
  EXPECT_EQ(text(encode_state_request(command_id(4))), "8004#11001C0401120E");
  EXPECT_EQ(text(encode_read(Register::kRegisterMap, command_id(4))), "8004#198202");
}

CanFrame state_answer(double mode, const std::array<double, 4>& motion, double temperature,
                      double fault) {
  FrameWriter frame(reply_id(4));
  const std::array last = {temperature, fault};
  frame.reply(Type::kInt8, 0x00, std::span(&mode, 1));
  frame.reply(Type::kFloat, 0x01, motion);
  frame.reply(Type::kInt8, 0x0E, last);
  return frame.frame();
}

TEST(MoteusMessages, StateIsAsLongAsPlanned) {
  const CanFrame frame = state_answer(10, {0.1, -0.025, 0.85, 1.5}, 30, 0);
  EXPECT_EQ(frame.length, 32);
  EXPECT_EQ(text(frame), "400#21000A2C0401CDCCCC3DCDCCCCBC9A99593F0000C03F220E1E00505050505050");
  State state;
  ASSERT_TRUE(decode_state(frame, &state));
  EXPECT_EQ(state.mode, Mode::kPosition);
  EXPECT_EQ(state.position_turns, static_cast<double>(0.1F));
  EXPECT_EQ(state.velocity_turns_per_s, static_cast<double>(-0.025F));
  EXPECT_EQ(state.torque_Nm, static_cast<double>(0.85F));
  EXPECT_EQ(state.current_q_A, 1.5);
  EXPECT_EQ(state.temperature_degC, 30.0);
  EXPECT_EQ(state.fault, 0);
}

TEST(MoteusMessages, StateComesInAnyFormat) {
  State state;
  ASSERT_TRUE(decode_state(parse("400#2405000B00E8039CFF55000F00220E1E25"), &state));
  EXPECT_EQ(state.mode, Mode::kTimeout);
  EXPECT_NEAR(state.position_turns, 0.1, 1e-12);
  EXPECT_NEAR(state.velocity_turns_per_s, -0.025, 1e-12);
  EXPECT_NEAR(state.torque_Nm, 0.85, 1e-12);
  EXPECT_NEAR(state.current_q_A, 1.5, 1e-12);
  EXPECT_EQ(state.fault, 37);
}

TEST(MoteusMessages, NothingIncompleteOrNotANumberPasses) {
  State state;
  for (std::size_t i = 0; i < 4; ++i) {
    for (double bad : {kNan, HUGE_VAL, -HUGE_VAL}) {
      std::array<double, 4> motion = {0.1, 0.2, 0.3, 0.4};
      EXPECT_TRUE(decode_state(state_answer(10, motion, 30, 0), &state));
      motion[i] = bad;
      EXPECT_FALSE(decode_state(state_answer(10, motion, 30, 0), &state)) << i;
    }
  }
  for (double bad : {-1.0, 16.0, 127.0, kNan})
    EXPECT_FALSE(decode_state(state_answer(bad, {0, 0, 0, 0}, 30, 0), &state)) << bad;
  EXPECT_FALSE(decode_state(state_answer(10, {0, 0, 0, 0}, kNan, 0), &state));
  EXPECT_FALSE(decode_state(state_answer(10, {0, 0, 0, 0}, 30, kNan), &state));
  CanFrame frame = state_answer(10, {0, 0, 0, 0}, 30, 0);
  for (std::uint8_t length = 0; length < 26; ++length) {
    frame.length = length;
    EXPECT_FALSE(decode_state(frame, &state)) << int{length};
  }
  frame.length = 26;
  EXPECT_TRUE(decode_state(frame, &state));
  frame.remote = true;
  EXPECT_FALSE(decode_state(frame, &state));
}

TEST(MoteusMessages, OneRegister) {
  double value = 0.0;
  ASSERT_TRUE(decode_register(parse("400#29820205000000"), Register::kRegisterMap, &value));
  EXPECT_EQ(value, 5.0);
  EXPECT_FALSE(decode_register(parse("400#29820205000000"), Register::kHomeState, &value));
  EXPECT_FALSE(decode_register(parse("400#31820201"), Register::kRegisterMap, &value));
  EXPECT_FALSE(decode_register(parse("400#298202050000"), Register::kRegisterMap, &value));
  EXPECT_FALSE(decode_register(parse("400#"), Register::kRegisterMap, &value));
}

// --- numbers ---

// --- the diagnostic channel ---

TEST(MoteusText, LinesAndPolls) {
  EXPECT_EQ(text(encode_line("tel stop", command_id(1))), "8001#40010974656C2073746F700A");
  EXPECT_EQ(text(encode_text_poll(command_id(1))), "8001#42011D");
  EXPECT_EQ(encode_line(std::string(100, 'x'), command_id(1)).length, 64);
}

TEST(MoteusText, AnswersMayBeEmpty) {
  std::string_view said = "nothing";
  const CanFrame ok = parse("100#4101044F4B0D0A");  // what was said stands in the frame
  EXPECT_TRUE(decode_text(ok, &said));
  EXPECT_EQ(said, "OK\r\n");
  const CanFrame silence = parse("100#410100");
  EXPECT_TRUE(decode_text(silence, &said));
  EXPECT_EQ(said, "");
  for (const char* none : {"100#", "100#210000", "100#4102024F4B", "100#4101054F4B", "100#41"})
    EXPECT_FALSE(decode_text(parse(none), &said)) << none;
}

TEST(MoteusText, BesideRegistersInOneFrame) {
  std::string_view said;
  const CanFrame frame = parse("100#21000A4101024F4B");
  EXPECT_TRUE(decode_text(frame, &said));
  EXPECT_EQ(said, "OK");
  double mode = 0.0;
  EXPECT_TRUE(decode_register(frame, Register::kMode, &mode));
  EXPECT_EQ(mode, 10.0);
}

TEST(MoteusText, WhatDoesNotFitIsLeftOutWhole) {
  FrameWriter frame(reply_id(1));
  EXPECT_EQ(frame.room_for_text(), 61U);
  EXPECT_TRUE(frame.text_from_drive(std::string(50, 'x')));
  EXPECT_EQ(frame.room_for_text(), 8U);
  EXPECT_FALSE(frame.text_from_drive(std::string(9, 'y')));
  EXPECT_TRUE(frame.text_from_drive(std::string(8, 'y')));
  EXPECT_EQ(frame.room_for_text(), 0U);
  EXPECT_FALSE(frame.text_poll(1));
}

TEST(MoteusNumbers, IntegersTruncateSaturateAndKnowNan) {
  for (Type type : {Type::kInt8, Type::kInt16, Type::kInt32}) {
    const double most = std::ldexp(1.0, 8 * size_of(type) - 1) - 1.0;
    for (double scale : {1.0, 0.0001, 0.5}) {
      EXPECT_EQ(to_integer(kNan, scale, type), -most - 1);
      EXPECT_TRUE(std::isnan(from_integer(to_integer(kNan, scale, type), scale, type)));
      for (double sign : {1.0, -1.0}) {
        EXPECT_EQ(to_integer(sign * HUGE_VAL, scale, type), sign * most);
        EXPECT_EQ(to_integer(sign * 1e30, scale, type), sign * most);
        EXPECT_EQ(to_integer(sign * (most + 0.4) * scale, scale, type), sign * most);
        EXPECT_EQ(to_integer(sign * 2.9 * scale, scale, type), sign * 2);
        EXPECT_EQ(to_integer(sign * 0.9 * scale, scale, type), 0);
        EXPECT_EQ(from_integer(static_cast<std::int32_t>(sign * most), scale, type),
                  sign * most * scale);
      }
    }
  }
}

TEST(MoteusNumbers, EveryQuantityHasItsScale) {
  const struct {
    Register reg;
    double scales[3];
  } table[] = {{Register::kPosition, {0.01, 1e-4, 1e-5}},
               {Register::kVelocity, {0.1, 2.5e-4, 1e-5}},
               {Register::kCommandAccelerationLimit, {0.05, 1e-3, 1e-5}},
               {Register::kTorque, {0.5, 0.01, 1e-3}},
               {Register::kCurrentQ, {1.0, 0.1, 1e-3}},
               {Register::kTemperature, {1.0, 0.1, 1e-3}},
               {Register::kVoltage, {0.5, 0.1, 1e-3}},
               {Register::kCommandWatchdog, {0.01, 1e-3, 1e-6}},
               {Register::kCommandKpScale, {1.0 / 127, 1.0 / 32767, 1.0 / 2147483647}},
               {Register::kMode, {1.0, 1.0, 1.0}}};
  for (const auto& row : table) {
    for (int i = 0; i < 3; ++i) EXPECT_EQ(lsb(number(row.reg), kTypes[i]), row.scales[i]);
    EXPECT_EQ(lsb(number(row.reg), Type::kFloat), 1.0);
  }
}

TEST(MoteusNumbers, WhatIsWrittenIsReadBackWithinACount) {
  for (Type type : kTypes) {
    for (double value : {0.0, 0.25, -0.25, 0.9, -0.9, kNan}) {
      for (Register reg : {Register::kPosition, Register::kTorque, Register::kCommandKpScale}) {
        FrameWriter writer(reply_id(1));
        ASSERT_TRUE(writer.reply(type, number(reg), std::span(&value, 1)));
        double back = 0.0;
        ASSERT_TRUE(decode_register(writer.frame(), reg, &back));
        const double count = type == Type::kFloat ? 1e-7 : lsb(number(reg), type) * (1.0 + 1e-9);
        EXPECT_TRUE(std::isnan(value) ? std::isnan(back) : std::abs(back - value) <= count);
      }
    }
  }
}

// --- frames in general ---

TEST(MoteusFrames, PaddingGivesEveryLengthAnFdFrameCanHave) {
  for (unsigned n = 0; n <= 60; ++n) {
    FrameWriter writer(command_id(1));
    const std::vector<double> values(n, 1.0);
    ASSERT_TRUE(n == 0 || writer.reply(Type::kInt8, 0x00, values));
    const CanFrame frame = writer.frame();
    EXPECT_TRUE(is_possible(frame)) << n;
    FrameReader reader(frame);
    Subframe subframe;
    EXPECT_EQ(reader.next(&subframe), n > 0);
    EXPECT_EQ(subframe.count, n);
    EXPECT_FALSE(reader.next(&subframe));  // padding only
    EXPECT_FALSE(reader.malformed());
  }
}

TEST(MoteusFrames, WhatDoesNotFitIsLeftOutWhole) {
  FrameWriter writer(command_id(1));
  const std::vector<double> values(14, 1.0);
  ASSERT_TRUE(writer.reply(Type::kFloat, 0x00, values));  // 59 bytes
  EXPECT_FALSE(writer.reply(Type::kFloat, 0x20, std::span(values.data(), 1)));
  EXPECT_TRUE(writer.read_error(0x102, kUnknownRegister));  // 4 more
  EXPECT_FALSE(writer.write_error(0x10, kNotWritable));
  EXPECT_FALSE(writer.read(Type::kInt8, 0x102, 9));
  const CanFrame frame = writer.frame();
  EXPECT_EQ(frame.length, 64);
  EXPECT_EQ(frame.data[59], 0x31);
  EXPECT_EQ(frame.data[63], 0x50);
}

TEST(MoteusFrames, ReadingStopsAtWhatCannotBeParsed) {
  for (const char* bad :
       {"0#32", "0#51", "0#40010203", "0#60", "0#FF", "0#0C", "0#0C05", "0#1D", "0#0D20000000",
        "0#24050000", "0#3082", "0#30828282828201", "0#1D808080"}) {
    CanFrame frame = parse(std::string(bad));
    FrameReader reader(frame);
    Subframe subframe;
    EXPECT_FALSE(reader.next(&subframe)) << bad;
    EXPECT_TRUE(reader.malformed()) << bad;
    EXPECT_FALSE(reader.next(&subframe)) << bad;
  }
  const CanFrame frame = parse("0#21000A60210001");  // what came before counts
  EXPECT_EQ(told(frame), "0=10 malformed");
}

TEST(MoteusFrames, RandomBytesAreReadWithinTheFrame) {
  std::uint32_t seed = 7;
  for (int round = 0; round < 20000; ++round) {
    CanFrame frame;
    frame.fd = true;
    for (auto& byte : frame.data) {
      seed = seed * 1664525U + 1013904223U;
      byte = static_cast<std::uint8_t>(seed >> 24U);
    }
    frame.length = static_cast<std::uint8_t>(fd_length(static_cast<int>(seed >> 8U) & 63));
    FrameReader reader(frame);
    Subframe subframe;
    int parts = 0;
    while (reader.next(&subframe)) {
      ASSERT_LE(++parts, 64);
      if (subframe.data == nullptr) continue;
      const auto end =
          subframe.data + subframe.count * static_cast<unsigned>(size_of(subframe.type));
      ASSERT_LE(end, frame.data.data() + frame.length);
    }
  }
}

TEST(MoteusMessages, NeverAllocate) {
  const std::int64_t before = allocations();
  State state;
  for (int i = 0; i < 100; ++i) {
    (void)encode_command({}, command_id(1));
    (void)decode_state(encode_stop(command_id(1)), &state);
  }
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace limber::moteus::test_moteus
