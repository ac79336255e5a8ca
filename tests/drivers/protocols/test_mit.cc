// Bytes of the MIT protocol against frames computed by hand from the manuals' field layout, and its
// algebra over whole fields.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "drivers/protocols/mit.h"
#include "tests/support/frame_text.h"
#include "tools/allocations/allocations.h"

namespace limber::mit::test_mit {
namespace {

constexpr CommandRange kDm4310{12.5, 30.0, 10.0, 500.0, 5.0};
constexpr CommandRange kAk80{12.5, 50.0, 18.0, 500.0, 5.0};
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::array kQuantisers = {Quantiser::kTruncate, Quantiser::kRound};

using limber::testing::parse;
using limber::testing::text;

std::string encoded(const Command& command, const CommandRange& range, std::uint32_t id,
                    Quantiser quantiser) {
  CanFrame frame;
  return encode_command(command, range, id, false, quantiser, &frame) ? text(frame) : "refused";
}

std::uint32_t raw_torque(const CanFrame& f) { return (f.data[6] & 0xFU) << 8U | f.data[7]; }
std::uint32_t raw_position(const CanFrame& f) {
  return static_cast<std::uint32_t>(f.data[0]) << 8U | f.data[1];
}

// --- worked frames ---

TEST(MitFrames, CommandOfFiveFields) {
  const Command command{1.0, -2.0, 60.0, 1.5, 2.5};
  EXPECT_EQ(encoded(command, kDm4310, 3, Quantiser::kTruncate), "003#8A3C7771EB4CC9FF");
  EXPECT_EQ(encoded(command, kDm4310, 3, Quantiser::kRound), "003#8A3D7771EB4CD9FF");
}

TEST(MitFrames, TorqueOnly) {
  const Command command{0.0, 0.0, 0.0, 0.0, -1.0};
  ASSERT_EQ(encoded(command, kDm4310, 3, Quantiser::kTruncate), "003#7FFF7FF000000732");
  Command back;
  ASSERT_TRUE(decode_command(parse("003#7FFF7FF000000732"), kDm4310, &back));
  EXPECT_NEAR(back.torque_Nm, -1.0037, 5e-5);
  EXPECT_NEAR(back.velocity_rad_per_s, -0.0073, 5e-5);
  EXPECT_EQ(back.kp_Nm_per_rad, 0.0);
  EXPECT_EQ(back.kd_Nms_per_rad, 0.0);
}

TEST(MitFrames, CommandOfAnotherMotor) {
  const Command command{-0.8, 3.0, 25.0, 0.8, -4.2};
  EXPECT_EQ(encoded(command, kAk80, 2, Quantiser::kTruncate), "002#77CE87A0CC28F621");
}

TEST(MitFrames, ReplyOfEnabledDrive) {
  Reply reply;
  ASSERT_TRUE(decode_reply(parse("013#1387AD7DD9702926"), kDm4310, &reply));
  EXPECT_EQ(reply.id_nibble, 3);
  EXPECT_EQ(reply.error, DriveError::kEnabled);
  EXPECT_NEAR(reply.position_rad, 0.7498, 5e-5);
  EXPECT_NEAR(reply.velocity_rad_per_s, -0.5055, 5e-5);
  EXPECT_NEAR(reply.torque_Nm, 1.7998, 5e-5);
  EXPECT_EQ(reply.mos_temperature_degC, 41);
  EXPECT_EQ(reply.rotor_temperature_degC, 38);
  EXPECT_EQ(text(encode_reply(reply, kDm4310, 0x13, false, Quantiser::kRound)),
            "013#1387AD7DD9702926");
}

TEST(MitFrames, ReplyAfterLossOfCommunication) {
  const Reply sent{3, DriveError::kCommunicationLost, 0.75, 0.0, 0.0, 41, 38};
  EXPECT_EQ(text(encode_reply(sent, kDm4310, 0x13, false, Quantiser::kTruncate)),
            "013#D387AD7FF7FF2926");
  Reply reply;
  ASSERT_TRUE(decode_reply(parse("013#D387AD7FF7FF2926"), kDm4310, &reply));
  EXPECT_EQ(reply.error, DriveError::kCommunicationLost);
  EXPECT_EQ(reply.id_nibble, 3);
}

TEST(MitFrames, Specials) {
  EXPECT_EQ(text(encode_special(Special::kEnable, 3, false)), "003#FFFFFFFFFFFFFFFC");
  EXPECT_EQ(text(encode_special(Special::kDisable, 3, false)), "003#FFFFFFFFFFFFFFFD");
  EXPECT_EQ(text(encode_special(Special::kSetZero, 3, false)), "003#FFFFFFFFFFFFFFFE");
  EXPECT_EQ(text(encode_special(Special::kClearError, 3, false)), "003#FFFFFFFFFFFFFFFB");
  for (const Special special :
       {Special::kEnable, Special::kDisable, Special::kSetZero, Special::kClearError}) {
    Special decoded{};
    ASSERT_TRUE(decode_special(encode_special(special, 3, true), &decoded));
    EXPECT_EQ(decoded, special);
  }
}

TEST(MitFrames, RegisterRead) {
  EXPECT_EQ(text(encode_register_read(3, Register::kTorqueRange, false)), "7FF#0300331700000000");
  std::uint32_t raw = 0;
  ASSERT_TRUE(
      decode_register(parse("013#0300331700002041"), 3, 0x33, Register::kTorqueRange, &raw));
  EXPECT_EQ(bits_float(raw), 10.0F);
  EXPECT_EQ(float_bits(10.0F), raw);
}

TEST(MitFrames, RegisterWriteAndEcho) {
  const auto counts = static_cast<std::uint32_t>(std::lround(0.020 / kTimeoutCount_s));
  EXPECT_EQ(counts, 400U);
  const CanFrame write = encode_register_write(3, Register::kTimeout, counts, false);
  EXPECT_EQ(text(write), "7FF#0300550990010000");
  RegisterRequest request;
  ASSERT_TRUE(decode_register_request(write, &request));
  EXPECT_EQ(request.id, 3);
  EXPECT_EQ(request.operation, 0x55);
  EXPECT_EQ(request.reg, 9);
  EXPECT_EQ(request.raw_value, 400U);
  const CanFrame echo = encode_register_answer(request, request.raw_value, 0x13, false);
  EXPECT_EQ(text(echo), "013#0300550990010000");
}

TEST(MitFrames, StateRequest) {
  EXPECT_EQ(text(encode_state_request(0x0103, false)), "7FF#0301CC0000000000");
  RegisterRequest request;
  ASSERT_TRUE(decode_register_request(encode_state_request(0x0103, true), &request));
  EXPECT_EQ(request.id, 0x0103);
  EXPECT_EQ(request.operation, 0xCC);
}

TEST(MitFrames, FdFramesSwitchTheirBitRateAndKeepTheirBytes) {
  CanFrame classic;
  CanFrame fd;
  const Command command{1.0, -2.0, 60.0, 1.5, 2.5};
  ASSERT_TRUE(encode_command(command, kDm4310, 3, false, Quantiser::kRound, &classic));
  ASSERT_TRUE(encode_command(command, kDm4310, 3, true, Quantiser::kRound, &fd));
  EXPECT_FALSE(classic.fd || classic.bitrate_switch);
  EXPECT_TRUE(fd.fd && fd.bitrate_switch);
  EXPECT_EQ(fd.length, 8);
  EXPECT_EQ(fd.data, classic.data);
}

// --- quantiser ---

TEST(MitQuantiser, EveryPositionCountSurvivesARoundTrip) {
  for (std::uint32_t count = 0; count <= 0xFFFF; ++count) {
    CanFrame frame = parse("003#0000000000000000");
    frame.data[0] = static_cast<std::uint8_t>(count >> 8U);
    frame.data[1] = static_cast<std::uint8_t>(count);
    Command command;
    ASSERT_TRUE(decode_command(frame, kDm4310, &command));
    CanFrame again;
    ASSERT_TRUE(encode_command(command, kDm4310, 3, false, Quantiser::kRound, &again));
    ASSERT_EQ(raw_position(again), count);
    // The middle of a truncating sender's step belongs to that step.
    command.position_rad += half_count(kDm4310.position_rad, 16);
    ASSERT_TRUE(encode_command(command, kDm4310, 3, false, Quantiser::kTruncate, &again));
    ASSERT_EQ(raw_position(again), count);
  }
}

TEST(MitQuantiser, EveryTwelveBitCountSurvivesARoundTripInEachField) {
  for (std::uint32_t count = 0; count <= 0xFFF; ++count) {
    CanFrame frame =
        parse("003#1234000000000000");  // position away from the top: no special frames
    frame.data[2] = static_cast<std::uint8_t>(count >> 4U);
    frame.data[3] = static_cast<std::uint8_t>((count & 0xFU) << 4U | count >> 8U);
    frame.data[4] = static_cast<std::uint8_t>(count);
    frame.data[5] = static_cast<std::uint8_t>(count >> 4U);
    frame.data[6] = static_cast<std::uint8_t>((count & 0xFU) << 4U | count >> 8U);
    frame.data[7] = static_cast<std::uint8_t>(count);
    Command command;
    ASSERT_TRUE(decode_command(frame, kAk80, &command));
    ASSERT_NEAR(command.kp_Nm_per_rad, 500.0 * count / 4095.0, 1e-10);
    ASSERT_NEAR(command.kd_Nms_per_rad, 5.0 * count / 4095.0, 1e-12);
    ASSERT_NEAR(command.torque_Nm, -18.0 + 36.0 * count / 4095.0, 1e-12);
    ASSERT_NEAR(command.velocity_rad_per_s, -50.0 + 100.0 * count / 4095.0, 1e-12);
    CanFrame again;
    ASSERT_TRUE(encode_command(command, kAk80, 3, false, Quantiser::kRound, &again));
    ASSERT_EQ(text(again), text(frame));
  }
}

TEST(MitQuantiser, ErrorIsAtMostOneCountTruncatingAndHalfACountRounding) {
  const double count_Nm = 2.0 * kDm4310.torque_Nm / 4095.0;
  for (int i = 0; i <= 10'000; ++i) {
    Command command;
    command.torque_Nm = -10.0 + 20.0 * i / 10'000.0;
    CanFrame frame;
    Command back;
    ASSERT_TRUE(encode_command(command, kDm4310, 1, false, Quantiser::kTruncate, &frame));
    ASSERT_TRUE(decode_command(frame, kDm4310, &back));
    ASSERT_LE(back.torque_Nm, command.torque_Nm + 1e-12);
    ASSERT_GT(back.torque_Nm, command.torque_Nm - count_Nm - 1e-12);
    ASSERT_TRUE(encode_command(command, kDm4310, 1, false, Quantiser::kRound, &frame));
    ASSERT_TRUE(decode_command(frame, kDm4310, &back));
    ASSERT_NEAR(back.torque_Nm, command.torque_Nm, count_Nm / 2 + 1e-12);
  }
}

// Steps of a field lie where the formula puts them: one count changes exactly at (k + 0) or (k +
// 1/2) counts.
TEST(MitQuantiser, BoundariesOfTheTorqueField) {
  const double count_Nm = 2.0 * kDm4310.torque_Nm / 4095.0;
  for (std::uint32_t k = 1; k <= 0xFFF; ++k) {
    for (const Quantiser quantiser : kQuantisers) {
      const double edge =
          -kDm4310.torque_Nm + (k - (quantiser == Quantiser::kRound ? 0.5 : 0.0)) * count_Nm;
      CanFrame below;
      CanFrame above;
      ASSERT_TRUE(encode_command({0, 0, 0, 0, edge - 1e-9}, kDm4310, 1, false, quantiser, &below));
      ASSERT_TRUE(encode_command({0, 0, 0, 0, edge + 1e-9}, kDm4310, 1, false, quantiser, &above));
      ASSERT_EQ(raw_torque(below), k - 1);
      ASSERT_EQ(raw_torque(above), k);
    }
  }
}

TEST(MitQuantiser, ATruncatedZeroWithHalfACountIsExactlyZero) {
  for (const double range : {1.0, 5.0, 10.0, 12.5, 12.566, 18.0, 28.0, 30.0, 54.0, 144.0, 0.1}) {
    const CommandRange ranges{range, range, range, 500.0, 5.0};
    const CanFrame frame = encode_reply({}, ranges, 0x13, false, Quantiser::kTruncate);
    Reply reply;
    ASSERT_TRUE(decode_reply(frame, ranges, &reply));
    EXPECT_LT(reply.torque_Nm, 0.0);
    EXPECT_EQ(reply.position_rad + half_count(range, 16), 0.0) << range;
    EXPECT_EQ(reply.velocity_rad_per_s + half_count(range, 12), 0.0) << range;
    EXPECT_EQ(reply.torque_Nm + half_count(range, 12), 0.0) << range;
  }
}

// --- what must not get through ---

TEST(MitRefusal, NonFiniteFieldsGiveNoFrame) {
  for (const double bad : {kNan, -kNan, kInf, -kInf}) {
    for (int field = 0; field < 5; ++field) {
      Command command;
      (field == 0   ? command.position_rad
       : field == 1 ? command.velocity_rad_per_s
       : field == 2 ? command.kp_Nm_per_rad
       : field == 3 ? command.kd_Nms_per_rad
                    : command.torque_Nm) = bad;
      CanFrame frame = parse("123#AB");
      EXPECT_FALSE(encode_command(command, kDm4310, 3, false, Quantiser::kRound, &frame));
      EXPECT_EQ(text(frame), "123#AB") << "an unsent frame was written";
    }
  }
}

TEST(MitRefusal, UnusableRangesGiveNoFrame) {
  for (const double bad : {0.0, -1.0, kNan, kInf}) {
    CommandRange range = kDm4310;
    range.torque_Nm = bad;
    CanFrame frame;
    EXPECT_FALSE(encode_command({}, range, 3, false, Quantiser::kRound, &frame));
  }
}

TEST(MitRefusal, OutOfRangeSaturates) {
  for (const Quantiser quantiser : kQuantisers) {
    EXPECT_EQ(encoded({-1e300, -1e300, -1e300, -1e300, -1e300}, kDm4310, 1, quantiser),
              "001#0000000000000000");
    EXPECT_EQ(encoded({99.0, 99.0, 9e9, 99.0, 0.0}, kDm4310, 1, quantiser).substr(0, 16),
              "001#FFFFFFFFFFFE");
    EXPECT_EQ(encoded({0, 0, 0, 0, 1e300}, kDm4310, 1, quantiser).substr(16), "0FFF");
  }
}

TEST(MitRefusal, ANaNInAReplyIsNoUndefinedCast) {
  const Reply reply{1, DriveError::kEnabled, kNan, kNan, kNan, 400, -400};
  EXPECT_EQ(text(encode_reply(reply, kDm4310, 0x11, false, Quantiser::kRound)),
            "011#110000000000FF00");
}

// Of a mini-cheetah special frame seven bytes are FF, of a RobStride one six: a change of protocol.
TEST(MitRefusal, NoCommandEverBeginsAsASpecialFrame) {
  for (const Quantiser quantiser : kQuantisers) {
    for (std::uint32_t torque = 0; torque <= 0xFFF; ++torque) {
      const double torque_Nm = -10.0 + (torque + 0.25) * 20.0 / 4095.0;
      for (std::uint32_t damping = 0xFE0; damping <= 0xFFF; ++damping) {
        const double kd = (damping + 0.25) * 5.0 / 4095.0;
        CanFrame frame;
        ASSERT_TRUE(
            encode_command({99, 99, 999, kd, torque_Nm}, kDm4310, 1, false, quantiser, &frame));
        EXPECT_EQ(frame.data[5], std::min(damping >> 4U, 0xFEU)) << text(frame);
        EXPECT_EQ(raw_torque(frame), torque) << "stays";
      }
    }
  }
}

TEST(MitRefusal, TheSameDampingIsLeftAloneBesideAnUnsaturatedField) {
  for (const Command& command : {Command{12.4, 99, 999, 99, 0}, Command{99, 29.9, 999, 99, 0},
                                 Command{99, 99, 499, 99, 0}}) {
    CanFrame frame;
    ASSERT_TRUE(encode_command(command, kDm4310, 1, false, Quantiser::kTruncate, &frame));
    EXPECT_EQ(frame.data[5], 0xFF);
    EXPECT_EQ(frame.data[6] >> 4U, 0xF);
  }
}

TEST(MitRefusal, ANodeTakesTheSpecialFrameForNoCommand) {
  Command command;
  for (const int last : {0xFB, 0xFC, 0xFD, 0xFE}) {
    CanFrame frame = parse("003#FFFFFFFFFFFFFFFF");
    frame.data[7] = static_cast<std::uint8_t>(last);
    EXPECT_FALSE(decode_command(frame, kDm4310, &command));
  }
  EXPECT_TRUE(decode_command(parse("003#FFFFFFFFFFFFFFFF"), kDm4310, &command));
  EXPECT_TRUE(decode_command(parse("003#FFFFFFFFFFFFFFFA"), kDm4310, &command));
}

TEST(MitRefusal, FramesOfOtherShapes) {
  CanFrame remote = parse("013#1387AD7DD9702926");
  remote.remote = true;
  CanFrame error = parse("013#1387AD7DD9702926");
  error.error = true;
  Reply reply;
  Command command;
  for (const CanFrame& frame : {parse("013#1387AD7DD97029"), remote, error}) {
    EXPECT_FALSE(decode_reply(frame, kDm4310, &reply));
    EXPECT_FALSE(decode_command(frame, kDm4310, &command));
  }
  Special special{};
  CanFrame asked = encode_special(Special::kEnable, 3, false);
  asked.remote = true;
  EXPECT_FALSE(decode_special(asked, &special));
  EXPECT_FALSE(decode_special(parse("003#FFFFFFFFFFFFFFFF"), &special));
  EXPECT_FALSE(decode_special(parse("003#FFFFFFFFFFFFFEFC"), &special));
}

TEST(MitRegisters, AnAnswerMustMatchIdOperationAndRegister) {
  const CanFrame answer = parse("013#0300331700002041");
  std::uint32_t raw = 77;
  EXPECT_FALSE(decode_register(answer, 4, 0x33, Register::kTorqueRange, &raw));
  EXPECT_FALSE(decode_register(answer, 0x0103, 0x33, Register::kTorqueRange, &raw));
  EXPECT_FALSE(decode_register(answer, 3, 0x55, Register::kTorqueRange, &raw));
  EXPECT_FALSE(decode_register(answer, 3, 0x33, Register::kVelocityRange, &raw));
  EXPECT_EQ(raw, 77U);
  CanFrame shorter = answer;
  shorter.length = 7;
  EXPECT_FALSE(decode_register(shorter, 3, 0x33, Register::kTorqueRange, &raw));
}

TEST(MitRegisters, RequestsOfOtherShapes) {
  RegisterRequest request;
  EXPECT_FALSE(decode_register_request(parse("7FE#0300331700000000"), &request));
  EXPECT_FALSE(decode_register_request(parse("7FF#0300441700000000"), &request))
      << "unknown operation";
  EXPECT_FALSE(decode_register_request(parse("7FF#030055"), &request));
  EXPECT_FALSE(decode_register_request(parse("7FF#03005509900100"), &request))
      << "a write without its whole value";
  EXPECT_TRUE(decode_register_request(parse("7FF#03003317"), &request)) << "a read needs no value";
  EXPECT_EQ(request.raw_value, 0U);
}

// Layouts of the maker's manual. 0.5: 0000003F, -2: 000000C0, 3: 00004040.
TEST(MitServo, CommandsOfTheOtherModes) {
  ServoCommand command;
  ASSERT_TRUE(decode_servo_command(parse("103#0000003F00004040"), ControlMode::kPositionVelocity,
                                   &command));
  EXPECT_EQ(command.position_rad, 0.5);
  EXPECT_EQ(command.velocity_rad_per_s, 3.0);
  EXPECT_EQ(command.torque_share, 1.0);
  ASSERT_TRUE(decode_servo_command(parse("203#000000C0"), ControlMode::kVelocity, &command));
  EXPECT_EQ(command.velocity_rad_per_s, -2.0);
  // 250 hundredths of rad/s, 2500 of 10000
  ASSERT_TRUE(
      decode_servo_command(parse("303#0000003FFA00C409"), ControlMode::kForcePosition, &command));
  EXPECT_NEAR(command.velocity_rad_per_s, 2.5, 1e-12);
  EXPECT_NEAR(command.torque_share, 0.25, 1e-12);
  ASSERT_TRUE(
      decode_servo_command(parse("303#0000003FFA00FFFF"), ControlMode::kForcePosition, &command));
  EXPECT_EQ(command.torque_share, 1.0);
  EXPECT_EQ(id_offset(ControlMode::kMit), 0U);
  EXPECT_EQ(id_offset(ControlMode::kForcePosition), 0x300U);
}

TEST(MitServo, WhatIsNoCommand) {
  ServoCommand command;
  command.position_rad = 9.0;
  const auto refused = [&command](const char* frame, ControlMode mode) {
    return !decode_servo_command(parse(frame), mode, &command) && command.position_rad == 9.0;
  };
  EXPECT_TRUE(refused("003#0000003F00004040", ControlMode::kMit));
  EXPECT_TRUE(refused("103#0000003F000040", ControlMode::kPositionVelocity));
  EXPECT_TRUE(refused("103#0000003F000000C0", ControlMode::kPositionVelocity));  // negative limit
  EXPECT_TRUE(refused("103#0000C07F00004040", ControlMode::kPositionVelocity));  // NaN
  EXPECT_TRUE(refused("103#0000003F0000807F", ControlMode::kPositionVelocity));  // infinite
  EXPECT_TRUE(refused("203#000000", ControlMode::kVelocity));
  EXPECT_TRUE(refused("203#0000C0FF", ControlMode::kVelocity));
  EXPECT_TRUE(refused("303#0000003FFA00", ControlMode::kForcePosition));
}

TEST(MitIds, NibbleHoldsTheLowFourBitsOfTheId) {
  Reply reply;
  reply.id_nibble = 0x1F;
  reply.error = DriveError::kEnabled;
  EXPECT_EQ(encode_reply(reply, kDm4310, 0x1F, false, Quantiser::kRound).data[0], 0x1F);
  reply.id_nibble = 0x23;  // must not leak into the error nibble
  EXPECT_EQ(encode_reply(reply, kDm4310, 0x23, false, Quantiser::kRound).data[0], 0x13);
}

TEST(MitIds, IdsBeyondElevenBitsAreExtended) {
  CanFrame frame;
  ASSERT_TRUE(encode_command({}, kDm4310, 0x7FF, false, Quantiser::kRound, &frame));
  EXPECT_FALSE(frame.extended);
  ASSERT_TRUE(encode_command({}, kDm4310, 0x800, false, Quantiser::kRound, &frame));
  EXPECT_TRUE(frame.extended);
  EXPECT_TRUE(is_possible(frame));
}

TEST(Mit, DoesNotAllocate) {
  const auto before = allocations();
  CanFrame frame;
  Reply reply;
  const bool encoded_well = encode_command({}, kDm4310, 1, true, Quantiser::kRound, &frame);
  const bool decoded_well = decode_reply(frame, kDm4310, &reply);
  EXPECT_EQ(allocations(), before);
  EXPECT_TRUE(encoded_well && decoded_well);
}

}  // namespace
}  // namespace limber::mit::test_mit
