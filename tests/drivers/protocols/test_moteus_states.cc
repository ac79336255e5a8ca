// States of moteus drives in whatever formats, and frames that are none.
#include <gtest/gtest.h>

#include <string>

#include "drivers/protocols/moteus.h"
#include "drivers/protocols/moteus_frame.h"

namespace limber::test_moteus_states {
namespace {

using namespace moteus;

struct Told {
  double mode = 10.0, temperature_degC = 40.0, fault = 0.0;
  bool position = true;
};
/// Whole numbers as int16.
CanFrame state(const Told& told) {
  FrameWriter writer(0x500);
  writer.reply(Type::kInt16, 0, std::array{told.mode});
  if (told.position) writer.reply(Type::kFloat, 1, std::array{0.25});
  writer.reply(Type::kFloat, 2, std::array{0.5, 1.5, 2.5});
  writer.reply(Type::kInt16, 0x00F, std::array{told.fault});
  writer.reply(Type::kFloat, 0x00E, std::array{told.temperature_degC});
  return writer.frame();
}
bool decoded(const CanFrame& frame) {
  State state;
  return decode_state(frame, &state);
}

TEST(MoteusStates, EveryPartIsThere) {
  State read;
  ASSERT_TRUE(decode_state(state({}), &read));
  EXPECT_EQ(read.mode, Mode::kPosition);
  EXPECT_EQ(read.position_turns, 0.25);
  EXPECT_EQ(read.current_q_A, 2.5);
  EXPECT_EQ(read.temperature_degC, 40.0);
  EXPECT_FALSE(decoded(state({.position = false})));
}

TEST(MoteusStates, ModesFrom0To15AndFaultsTo255) {
  for (const double mode : {0.0, 1.0, 15.0}) EXPECT_TRUE(decoded(state({.mode = mode}))) << mode;
  for (const double mode : {-1.0, 16.0}) EXPECT_FALSE(decoded(state({.mode = mode}))) << mode;
  for (const double fault : {255.0, -255.0}) EXPECT_TRUE(decoded(state({.fault = fault}))) << fault;
  for (const double fault : {256.0, -256.0})
    EXPECT_FALSE(decoded(state({.fault = fault}))) << fault;
  EXPECT_TRUE(decoded(state({.temperature_degC = 300.0}))) << "hot, but a state";
}

TEST(MoteusStates, AFrameThatGoesOnWithNonsenseIsNone) {
  CanFrame frame = state({});
  std::size_t end = frame.length;
  while (frame.data[end - 1] == 0x50) --end;
  ASSERT_LT(end, frame.length);
  frame.data[end] = 0x60;
  EXPECT_FALSE(decoded(frame));
}

TEST(MoteusStates, ErrorFramesAndRemoteFramesAreNoReplies) {
  FrameWriter text(0x500);
  text.text_from_drive("hi");
  for (bool CanFrame::*kind : {&CanFrame::error, &CanFrame::remote}) {
    CanFrame frame = state({});
    CanFrame said = text.frame();
    double value = 0.0;
    std::string_view heard;
    ASSERT_TRUE(decode_register(frame, Register::kPosition, &value));
    ASSERT_TRUE(decode_text(said, &heard));
    frame.*kind = said.*kind = true;
    EXPECT_FALSE(decoded(frame));
    EXPECT_FALSE(decode_register(frame, Register::kPosition, &value));
    EXPECT_FALSE(decode_text(said, &heard));
  }
}

TEST(MoteusStates, ARegisterThatIsNotThereHasNoValue) {
  FrameWriter writer(0x500);
  writer.reply(Type::kInt8, 5, std::array{1.0, 2.0});
  double value = 0.0;
  EXPECT_TRUE(decode_register(writer.frame(), static_cast<Register>(6), &value));
  EXPECT_FALSE(decode_register(writer.frame(), static_cast<Register>(7), &value));
  EXPECT_FALSE(decode_register(writer.frame(), static_cast<Register>(4), &value));
}

TEST(MoteusStates, TextToADriveIsNotItsOwn) {
  FrameWriter writer(0x500);
  writer.text_to_drive("hi");
  std::string_view heard;
  EXPECT_FALSE(decode_text(writer.frame(), &heard));
}

TEST(MoteusStates, ALineOfSixtyCharactersAtMost) {
  for (const std::size_t length : {59u, 60u, 70u}) {
    const CanFrame frame = encode_line(std::string(length, 'x'), 0x8005);
    const std::size_t sent = std::min<std::size_t>(length, 60);
    EXPECT_EQ(frame.data[2], sent + 1) << length;
    EXPECT_EQ(frame.data[2 + sent], 'x');
    EXPECT_EQ(frame.data[3 + sent], '\n');
  }
}

TEST(MoteusStates, NothingIsSet) {
  const Command command;
  const State none;
  for (const double value :
       {command.position_turns, command.velocity_turns_per_s, command.torque_Nm, command.kp_scale,
        command.kd_scale, command.max_torque_Nm, command.watchdog_s, none.position_turns,
        none.velocity_turns_per_s, none.torque_Nm, none.current_q_A, none.temperature_degC})
    EXPECT_EQ(value, 0.0);
  EXPECT_EQ(none.mode, Mode::kStopped);
  EXPECT_EQ(none.fault, 0);
}

}  // namespace
}  // namespace limber::test_moteus_states
