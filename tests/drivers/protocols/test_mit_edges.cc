// MIT frames where they end: foreign frames, ranges that are none, registers of long numbers.
#include <gtest/gtest.h>

#include <limits>

#include "drivers/protocols/mit.h"
#include "tests/support/frame_text.h"

namespace limber::test_mit_edges {
namespace {

using testing::parse;
using testing::text;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

enum class Spoiled { kRemote, kError, kExtended };
CanFrame spoiled(const std::string& candump, Spoiled how) {
  CanFrame frame = parse(candump);
  if (how == Spoiled::kRemote) frame.remote = true;
  if (how == Spoiled::kError) frame.error = true;
  if (how == Spoiled::kExtended) frame.extended = true;
  return frame;
}

TEST(MitRegisters, AnswersOfAnyNumber) {
  std::uint32_t value = 0;
  const auto decoded = [&](const CanFrame& frame, int operation = 0x33, int id = 0x0201) {
    return mit::decode_register(frame, static_cast<std::uint16_t>(id),
                                static_cast<std::uint8_t>(operation), mit::Register::kTimeout,
                                &value);
  };
  ASSERT_TRUE(decoded(parse("011#0102330978563412")));
  EXPECT_EQ(value, 0x12345678u);
  EXPECT_TRUE(decoded(parse("011#0102550978563412"), 0x55));
  EXPECT_FALSE(decoded(parse("011#0102AA0978563412"), 0xAA)) << "no answer has a value but these";
  EXPECT_FALSE(decoded(parse("011#0102330978563412"), 0x55));
  EXPECT_FALSE(decoded(parse("011#0100330978563412"))) << "number 1";
  EXPECT_FALSE(decoded(parse("011#0102330A78563412")));
  EXPECT_FALSE(decoded(parse("011#01023309785634")));
  EXPECT_FALSE(decoded(spoiled("011#0102330978563412", Spoiled::kRemote)));
  EXPECT_FALSE(decoded(spoiled("011#0102330978563412", Spoiled::kError)));
}

TEST(MitRegisters, Requests) {
  mit::RegisterRequest request;
  const auto decoded = [&](const CanFrame& frame) {
    return mit::decode_register_request(frame, &request);
  };
  ASSERT_TRUE(decoded(parse("7FF#0102550978563412")));
  EXPECT_EQ(request.id, 0x0201);
  EXPECT_EQ(request.operation, 0x55);
  EXPECT_EQ(request.reg, 9);
  EXPECT_EQ(request.raw_value, 0x12345678u);
  ASSERT_TRUE(decoded(parse("7FF#0100AA01"))) << "stored, in four bytes";
  EXPECT_EQ(request.raw_value, 0u);
  EXPECT_TRUE(decoded(parse("7FF#0100330A")));
  EXPECT_TRUE(decoded(parse("7FF#0100CC00")));
  EXPECT_FALSE(decoded(parse("7FF#0100A90100000000")));
  EXPECT_FALSE(decoded(parse("7FF#0100AB0100000000")));
  EXPECT_FALSE(decoded(parse("7FF#010033"))) << "no register";
  EXPECT_FALSE(decoded(parse("7FF#0102550978"))) << "no whole value";
  for (const Spoiled how : {Spoiled::kRemote, Spoiled::kError, Spoiled::kExtended})
    EXPECT_FALSE(decoded(spoiled("7FF#0100330A00000000", how)));
  EXPECT_EQ(text(mit::encode_register_write(0x0201, mit::Register::kTimeout, 0x12345678, false)),
            "7FF#0102550978563412");
}

TEST(MitCommands, ARangeThatIsNoneHasNoCommand) {
  for (double CommandRange::*field :
       {&CommandRange::position_rad, &CommandRange::velocity_rad_per_s, &CommandRange::torque_Nm,
        &CommandRange::kp_Nm_per_rad, &CommandRange::kd_Nms_per_rad}) {
    CanFrame frame;
    const auto encoded = [&](double value) {
      CommandRange range;
      range.*field = value;
      return mit::encode_command({}, range, 1, false, mit::Quantiser::kRound, &frame);
    };
    EXPECT_TRUE(encoded(0.5));
    for (const double bad : {0.0, -1.0, kNan, kInf}) EXPECT_FALSE(encoded(bad)) << bad;
  }
}

// All fields at the top: the damping gives way, whatever the torque.
TEST(MitCommands, NoneBeginsAsASpecialFrame) {
  const CommandRange range{1.0, 1.0, 4095.0, 1.0, 4095.0};
  const auto encoded = [&](double position, int damping_count, int torque_count) {
    CanFrame frame;
    EXPECT_TRUE(
        mit::encode_command({position, 1.0, 1.0, 1.0 * damping_count, 2.0 * torque_count - 4095.0},
                            range, 1, false, mit::Quantiser::kRound, &frame));
    return text(frame);
  };
  EXPECT_EQ(encoded(1.0, 0xFFF, 0xFFC), "001#FFFFFFFFFFFEFFFC");
  EXPECT_EQ(encoded(1.0, 0xFF0, 0x800), "001#FFFFFFFFFFFEF800");
  EXPECT_EQ(encoded(1.0, 0xFEF, 0xFFC), "001#FFFFFFFFFFFEFFFC") << "the first that needs not";
  EXPECT_EQ(encoded(-1.0, 0xFFF, 0xFFC), "001#0000FFFFFFFFFFFC") << "one field is not at the top";
}

TEST(MitSpecials, EightBytes) {
  mit::Special special{};
  EXPECT_TRUE(mit::decode_special(parse("001#FFFFFFFFFFFFFFFC"), &special));
  CanFrame longer = parse("001#FFFFFFFFFFFFFFFC");
  longer.length = 12;
  EXPECT_FALSE(mit::decode_special(longer, &special));
  EXPECT_FALSE(mit::decode_special(parse("001#FFFFFFFFFFFFFF"), &special));
}

TEST(MitServo, StandstillIsASpeed) {
  mit::ServoCommand command;
  EXPECT_TRUE(mit::decode_servo_command(parse("101#0000803F00000000"),
                                        mit::ControlMode::kPositionVelocity, &command));
  EXPECT_EQ(command.velocity_rad_per_s, 0.0);
  EXPECT_TRUE(mit::decode_servo_command(parse("101#0000803F0000003F"),
                                        mit::ControlMode::kPositionVelocity, &command));
  EXPECT_EQ(command.velocity_rad_per_s, 0.5);
  EXPECT_FALSE(mit::decode_servo_command(parse("101#0000803F000080BF"),
                                         mit::ControlMode::kPositionVelocity, &command));
  for (const Spoiled how : {Spoiled::kRemote, Spoiled::kError}) {
    EXPECT_FALSE(mit::decode_servo_command(spoiled("101#0000803F00000000", how),
                                           mit::ControlMode::kPositionVelocity, &command));
  }
}

TEST(MitReplies, TemperaturesFitAByte) {
  const auto last_bytes = [](int mos, int rotor) {
    mit::Reply reply;
    reply.mos_temperature_degC = mos;
    reply.rotor_temperature_degC = rotor;
    return text(mit::encode_reply(reply, {}, 0x11, false, mit::Quantiser::kRound)).substr(16);
  };
  EXPECT_EQ(last_bytes(0, 255), "00FF");
  EXPECT_EQ(last_bytes(-1, 256), "00FF");
  EXPECT_EQ(last_bytes(255, -5), "FF00");
  EXPECT_EQ(last_bytes(300, 254), "FFFE");
}

TEST(MitDefaults, NothingIsSet) {
  const mit::Command command;
  const mit::Reply reply;
  for (const double value :
       {command.position_rad, command.velocity_rad_per_s, command.kp_Nm_per_rad,
        command.kd_Nms_per_rad, command.torque_Nm, reply.position_rad, reply.velocity_rad_per_s,
        reply.torque_Nm, mit::ServoCommand{}.position_rad, mit::ServoCommand{}.velocity_rad_per_s})
    EXPECT_EQ(value, 0.0);
  EXPECT_EQ(reply.error, mit::DriveError::kDisabled);
  EXPECT_EQ(reply.id_nibble + reply.mos_temperature_degC + reply.rotor_temperature_degC, 0);
  const mit::RegisterRequest request;
  EXPECT_EQ(request.id + request.operation + request.reg, 0);
  EXPECT_EQ(request.raw_value, 0u);
}

}  // namespace
}  // namespace limber::test_mit_edges
