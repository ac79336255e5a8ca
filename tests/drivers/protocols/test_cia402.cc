// CiA 402 against its tables: statuswords, controlwords, every state with every command, and the
// PDOs byte by byte (node 3, rated torque 28 N m where nothing else is said).
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "drivers/protocols/cia402_pdos.h"
#include "tests/support/frame_text.h"
#include "tools/allocations/allocations.h"

namespace limber::cia402::test_cia402 {
namespace {

using limber::testing::parse;
using limber::testing::text;

/// One letter a state: not ready, (switch on) disabled, ready, switched on, enabled, quick stop,
/// fault reaction, fault.
constexpr char kLetters[] = "NDRSEQXF";
char letter(State state) { return kLetters[static_cast<int>(state)]; }

// --- words ---

TEST(Cia402Words, Statuswords) {
  const std::map<std::uint16_t, char> words = {
      {0x0000, 'N'}, {0x0250, 'D'}, {0x0270, 'D'}, {0x0231, 'R'}, {0x0233, 'S'}, {0x1637, 'E'},
      {0x0237, 'E'}, {0x0217, 'Q'}, {0x021F, 'X'}, {0x023F, 'X'}, {0x0218, 'F'}, {0x0238, 'F'},
  };
  for (const auto& [word, state] : words) EXPECT_EQ(letter(state_of(word)), state) << word;
}

TEST(Cia402Words, EveryStateIsReadBackFromItsStatusword) {
  for (int i = 0; i < kStates; ++i) {
    const auto state = static_cast<State>(i);
    for (const std::uint16_t others : {0x0000, 0x0290, 0x1C00, 0xFF90})
      EXPECT_EQ(state_of(statusword_of(state) | others), state) << name_of(state);
  }
  EXPECT_STREQ(name_of(State::kOperationEnabled), "operation enabled");
}

TEST(Cia402Words, EveryControlword) {
  // Bits 7 and 3 to 0, by the profile's table; the others (halt, mode) change nothing.
  for (unsigned low = 0; low < 16; ++low) {
    const Command expected = (low & 2U) == 0   ? Command::kDisableVoltage
                             : (low & 4U) == 0 ? Command::kQuickStop
                             : (low & 1U) == 0 ? Command::kShutdown
                             : (low & 8U) == 0 ? Command::kSwitchOn
                                               : Command::kEnableOperation;
    for (const unsigned others : {0x0000U, 0x0170U, 0xFF00U}) {
      const auto word = static_cast<std::uint16_t>(low | others);
      EXPECT_EQ(command_of(word, 0), expected) << word;
      EXPECT_EQ(command_of(word, kFaultReset), expected) << word;
      EXPECT_EQ(command_of(word | kFaultReset, word), Command::kFaultReset) << word;
      EXPECT_EQ(command_of(word | kFaultReset, kFaultReset), Command::kNone) << word;
    }
  }
}

TEST(Cia402Words, NamesOfControlwords) {
  EXPECT_EQ(command_of(kShutdown, 0), Command::kShutdown);
  EXPECT_EQ(command_of(kSwitchOn, 0), Command::kSwitchOn);
  EXPECT_EQ(command_of(kEnableOperation, 0), Command::kEnableOperation);
  EXPECT_EQ(command_of(kDisableVoltage, 0), Command::kDisableVoltage);
  EXPECT_EQ(command_of(kQuickStop, 0), Command::kQuickStop);
  EXPECT_EQ(command_of(kFaultReset, 0), Command::kFaultReset);
}

// --- state machine ---

/// Where each state (row order of kLetters) goes.
std::string goes(Command command, bool enable_after_quick_stop) {
  std::string to;
  for (int i = 0; i < kStates; ++i)
    to += letter(next_state(static_cast<State>(i), command, enable_after_quick_stop));
  return to;
}

TEST(Cia402States, EveryCommandInEveryState) {
  for (const bool after_quick_stop : {false, true}) {
    // from:                                                         NDRSEQXF
    EXPECT_EQ(goes(Command::kNone, after_quick_stop), "NDRSEQXF");
    EXPECT_EQ(goes(Command::kShutdown, after_quick_stop), "NRRRRQXF");
    EXPECT_EQ(goes(Command::kSwitchOn, after_quick_stop), "NDSSSQXF");
    EXPECT_EQ(goes(Command::kEnableOperation, after_quick_stop),
              after_quick_stop ? "NDEEEEXF" : "NDEEEQXF");
    EXPECT_EQ(goes(Command::kDisableVoltage, after_quick_stop), "NDDDDDXF");
    EXPECT_EQ(goes(Command::kQuickStop, after_quick_stop), "NDDDQQXF");
    EXPECT_EQ(goes(Command::kFaultReset, after_quick_stop), "NDRSEQXD");
  }
}

TEST(Cia402States, TowardsEnabledArrivesFromEverywhere) {
  for (int i = 0; i < kStates; ++i) {
    auto state = static_cast<State>(i);
    if (state == State::kNotReady || state == State::kFaultReactionActive) continue;  // by itself
    std::uint16_t last = 0;
    for (int step = 0; step < 5; ++step) {
      std::uint16_t word = towards_enabled(state);
      if (state == State::kFault && step > 0) word = kFaultReset;
      state = next_state(state, command_of(word, last), false);
      last = word;
    }
    EXPECT_EQ(state, State::kOperationEnabled) << name_of(static_cast<State>(i));
  }
}

// --- PDOs ---

TEST(Cia402Pdos, EnableWithTorque) {
  const std::int16_t torque = to_permille(5.6, 28.0);
  EXPECT_EQ(torque, 200);
  EXPECT_EQ(text(encode_command({kEnableOperation, torque}, 0x203, false)), "203#0F00C800");
  EXPECT_EQ(text(encode_command({kEnableOperation, -200}, 0x203, true)), "203#0F0038FF");
  DriveCommand command;
  ASSERT_TRUE(decode_command(parse("203#0F0038FF"), &command));
  EXPECT_EQ(command.controlword, 0x000F);
  EXPECT_EQ(command.torque_permille, -200);
  EXPECT_FALSE(decode_command(parse("203#0F0038"), &command));
}

constexpr DriveState kState = {0x1637, 81920, -256, -15, 30, -5, -6};

/// The frames that tell kState.
std::vector<std::string> frames_of(const StateLayout& layout) {
  std::vector<std::string> frames;
  for (int k = 0; k < tpdos_of(layout); ++k)
    frames.push_back(
        text(encode_state(kState, state_objects(layout, k), canopen::tpdo_id(k, 3), layout.fd)));
  return frames;
}

TEST(Cia402Pdos, StateInClassicFrames) {
  using Frames = std::vector<std::string>;
  EXPECT_EQ(frames_of({}), Frames({"183#371600400100", "283#00FFFFFFF1FF"}));
  EXPECT_EQ(frames_of({.torque_sensor = true}),
            Frames({"183#371600400100", "283#00FFFFFFF1FF1E00"}));
  EXPECT_EQ(frames_of({.link_encoder = true}),
            Frames({"183#371600400100", "283#00FFFFFFF1FF", "383#FBFFFFFFFAFFFFFF"}));
  EXPECT_EQ(frames_of({.link_encoder = true, .torque_sensor = true}),
            Frames({"183#371600400100", "283#00FFFFFFF1FF1E00", "383#FBFFFFFFFAFFFFFF"}));
}

TEST(Cia402Pdos, StateInOneFdFrame) {
  using Frames = std::vector<std::string>;
  EXPECT_EQ(frames_of({.fd = true}), Frames({"183#37160040010000FFFFFFF1FF1E000000"}));
  EXPECT_EQ(frames_of({.fd = true, .torque_sensor = true}), frames_of({.fd = true}));
  EXPECT_EQ(frames_of({.fd = true, .link_encoder = true}),
            Frames({"183#37160040010000FFFFFFF1FF1E00FBFFFFFFFAFFFFFF0000"}));
}

TEST(Cia402Pdos, EveryFrameIsReadBack) {
  for (unsigned bits = 0; bits < 8; ++bits) {
    const StateLayout layout = {(bits & 1U) != 0, (bits & 2U) != 0, (bits & 4U) != 0};
    DriveState read;
    for (int k = 0; k < tpdos_of(layout); ++k) {
      const auto objects = state_objects(layout, k);
      CanFrame frame = encode_state(kState, objects, 0x183, layout.fd);
      ASSERT_TRUE(decode_state(frame, objects, &read));
      const DriveState before = read;
      frame.remote = true;
      EXPECT_FALSE(decode_state(frame, objects, &read));
      frame.remote = false;
      frame.length = static_cast<std::uint8_t>(layout.fd ? 12 : frame.length - 1);
      EXPECT_FALSE(decode_state(frame, objects, &read));  // too short
      EXPECT_EQ(read.statusword, before.statusword);
    }
    EXPECT_EQ(read.statusword, 0x1637);
    EXPECT_EQ(read.position_counts, 81920);
    EXPECT_EQ(read.velocity_counts_per_s, -256);
    EXPECT_EQ(read.torque_permille, -15);
    EXPECT_EQ(read.current_permille, layout.fd || layout.torque_sensor ? 30 : 0);
    EXPECT_EQ(read.link_position_counts, layout.link_encoder ? -5 : 0);
    EXPECT_EQ(read.link_velocity_counts_per_s, layout.link_encoder ? -6 : 0);
  }
}

TEST(Cia402Pdos, ObjectsAddUpToTheFrames) {
  int bytes = 0;
  for (const Object& object : command_objects()) bytes += object.bytes;
  EXPECT_EQ(bytes, 4);
  EXPECT_EQ(state_objects({.fd = true, .link_encoder = true}, 0)[5].mapping(), 0x60E40120U);
  EXPECT_TRUE(state_objects({.fd = true, .link_encoder = true}, 1).empty());
  EXPECT_TRUE(state_objects({}, 2).empty());
}

TEST(Cia402Pdos, ThousandthsRoundAndSaturate) {
  EXPECT_EQ(to_permille(-0.42, 28.0), -15);
  EXPECT_EQ(to_permille(0.0139, 28.0), 0);  // 0.496 thousandths
  EXPECT_EQ(to_permille(0.0141, 28.0), 1);
  EXPECT_EQ(to_permille(1e9, 28.0), 32767);
  EXPECT_EQ(to_permille(-1e9, 28.0), -32767);
  EXPECT_EQ(to_permille(std::numeric_limits<double>::quiet_NaN(), 28.0), 0);
  EXPECT_DOUBLE_EQ(from_permille(-15, 28.0), -0.42);
  for (int permille = -32767; permille <= 32767; permille += 7)
    EXPECT_EQ(to_permille(from_permille(static_cast<std::int16_t>(permille), 6.2), 6.2), permille);
}

TEST(Cia402Pdos, NeverAllocate) {
  const std::int64_t before = allocations();
  DriveState state;
  DriveCommand command;
  const auto objects = state_objects({.link_encoder = true}, 2);
  EXPECT_TRUE(decode_state(encode_state({}, objects, 0x383, false), objects, &state));
  EXPECT_TRUE(decode_command(encode_command({}, 0x203, true), &command));
  EXPECT_EQ(allocations(), before);
}

// Object 6072h: whole thousandths of the rated torque within the joint's limit.
TEST(Cia402, TheMostThousandthsOfAJoint) {
  const auto most = [](double limit_Nm, double range_Nm, double rated_Nm) {
    JointConfig joint;
    joint.torque_limit_Nm = limit_Nm;
    joint.drive.range.torque_Nm = range_Nm;
    joint.drive.rated_torque_Nm = rated_Nm;
    return most_permille(joint);
  };
  EXPECT_EQ(most(60.0, 500.0, 9.0), 6666U) << "6666.67";
  EXPECT_EQ(most(500.0, 60.0, 9.0), 6666U) << "by the drive";
  EXPECT_EQ(most(9.0, 500.0, 9.0), 1000U);
  EXPECT_EQ(most(400.0, 500.0, 1.0), 32767U) << "of 16 bits";
  EXPECT_EQ(most(1.1, 500.0, 1.1), 1000U) << "a whole number, but for rounding";
}

}  // namespace
}  // namespace limber::cia402::test_cia402
