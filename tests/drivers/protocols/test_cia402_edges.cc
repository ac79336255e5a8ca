// CiA 402 where nothing fits: statuswords of no state, objects of no field, frames of other kinds.
#include <gtest/gtest.h>

#include "drivers/protocols/cia402.h"
#include "drivers/protocols/cia402_pdos.h"
#include "tests/support/frame_text.h"

namespace limber::test_cia402_edges {
namespace {

using testing::parse;

TEST(Cia402Edges, AStatuswordOfNoStateIsNotReady) {
  for (const int word : {0x0001, 0x0003, 0x0005})
    EXPECT_EQ(cia402::state_of(static_cast<std::uint16_t>(word)), cia402::State::kNotReady) << word;
}

TEST(Cia402Edges, AFaultIsLeftWithoutVoltage) {
  for (const cia402::State state : {cia402::State::kFault, cia402::State::kFaultReactionActive,
                                    cia402::State::kQuickStopActive})
    EXPECT_EQ(cia402::towards_enabled(state), 0);
}

TEST(Cia402Edges, AnObjectThatIsNoPartOfTheStateIsZero) {
  const canopen::Object other[] = {{{0x2345, 6}, 2}};
  EXPECT_EQ(testing::text(cia402::encode_state({}, other, 0x185, false)), "185#0000");
}

TEST(Cia402Edges, ErrorFramesAndRemoteFramesAreNone) {
  const cia402::StateLayout layout;
  const auto objects = cia402::state_objects(layout, 0);
  for (bool CanFrame::*kind : {&CanFrame::error, &CanFrame::remote}) {
    CanFrame command = parse("205#0F000A00");
    CanFrame state = parse("185#371200000100");
    cia402::DriveCommand commanded;
    cia402::DriveState told;
    ASSERT_TRUE(cia402::decode_command(command, &commanded));
    ASSERT_TRUE(cia402::decode_state(state, objects, &told));
    command.*kind = state.*kind = true;
    EXPECT_FALSE(cia402::decode_command(command, &commanded));
    EXPECT_FALSE(cia402::decode_state(state, objects, &told));
  }
}

TEST(Cia402Edges, NothingIsSet) {
  const cia402::DriveCommand command;
  EXPECT_EQ(command.controlword, 0);
  EXPECT_EQ(command.torque_permille, 0);
  const cia402::DriveState state;
  EXPECT_EQ(state.statusword, 0);
  EXPECT_EQ(state.position_counts, 0);
  EXPECT_EQ(state.velocity_counts_per_s, 0);
  EXPECT_EQ(state.torque_permille, 0);
}

}  // namespace
}  // namespace limber::test_cia402_edges
