// One drive's start-up as its counters see it: what is heard, late, silent or not understood, and
// what is forgotten when it begins.
#include <gtest/gtest.h>

#include "drivers/drive/drive.h"
#include "tests/drivers/drive/damiao_reply.h"

namespace limber::test_drive_startup {
namespace {

using testing::DamiaoReply;
using testing::FakeMotor;
using testing::kEnabled;
using State = DriveState;

constexpr DamiaoReply kDisabledAtZero{testing::kDisabled, 0.0, 0.0, 0.0};

class DriveStartup : public ::testing::Test {
 protected:
  /// The reply to this cycle's frame, which the drive does not get unless `hears`.
  CanFrame cycle(State state, bool hears) {
    CanFrame reply;
    motor.handle(drive.next_frame(state, 0.0, true), &reply);
    if (hears) drive.receive(state, reply);
    close(state);
    drive.begin_cycle();
    return reply;
  }
  void silence(int cycles, State state = State::kConfiguring) {
    for (int i = 0; i < cycles; ++i) cycle(state, false);
  }
  void close(State state) {
    drive.close_cycle(state, number, 1e-3 * static_cast<double>(number));
    ++number;
  }
  /// Behind the disabling, where the dialogue waits for registers.
  void disable() {
    drive.enter(State::kConfiguring, 0.0, 0.0);
    cycle(State::kConfiguring, true);
  }

  JointConfig joint = testing::test_robot(1).joints[0];
  FakeMotor motor{joint.drive};
  Drive drive{joint, true, 1000.0, 2};
  std::int64_t number = 0;
};

TEST_F(DriveStartup, AnAnswerIsNeitherLostNorInvalid) {
  drive.enter(State::kConfiguring, 0.0, 0.0);
  for (int i = 0; i < 100 && !drive.configured(); ++i) cycle(State::kConfiguring, true);
  EXPECT_TRUE(drive.configured());
  EXPECT_EQ(drive.replies_invalid(), 0);
  EXPECT_EQ(drive.replies_lost(), 0);
  EXPECT_EQ(drive.replies_late(), 0);
}

TEST_F(DriveStartup, AnotherRegistersAnswerIsInvalid) {
  disable();
  CanFrame other = cycle(State::kConfiguring, false);
  other.data[3] = 99;
  drive.receive(State::kConfiguring, other);
  EXPECT_EQ(drive.replies_invalid(), 1);
}

// The wire is shared with the dialogues of all other drives: an answer may take two cycles.
TEST_F(DriveStartup, TheThirdSilentCycleIsALoss) {
  disable();
  silence(2);
  EXPECT_EQ(drive.replies_lost(), 0);
  silence(1);
  EXPECT_EQ(drive.replies_lost(), 1);
}

TEST_F(DriveStartup, AnAnswerEndsTheSilence) {
  disable();
  const CanFrame answer = cycle(State::kConfiguring, false);
  silence(1);
  drive.receive(State::kConfiguring, answer);
  ASSERT_TRUE(drive.answered());
  silence(1);  // what this cycle's own request got
  silence(2);
  EXPECT_EQ(drive.replies_lost(), 0);
  silence(1);
  EXPECT_EQ(drive.replies_lost(), 1);
}

TEST_F(DriveStartup, ALateAnswerEndsTheSilenceOfItsCycleAlone) {
  disable();
  const CanFrame answer = cycle(State::kConfiguring, false);
  silence(1);
  drive.receive_late(State::kConfiguring, answer);
  silence(1);
  EXPECT_EQ(drive.replies_late(), 0);
  EXPECT_EQ(drive.replies_lost(), 0);
  silence(2);
  EXPECT_EQ(drive.replies_lost(), 0);
  silence(1);
  EXPECT_EQ(drive.replies_lost(), 1);
}

TEST_F(DriveStartup, AnotherRegistersLateAnswerEndsNoSilence) {
  disable();
  CanFrame other = cycle(State::kConfiguring, false);
  other.data[3] = 99;
  silence(1);
  drive.receive_late(State::kConfiguring, other);
  silence(1);
  EXPECT_EQ(drive.replies_lost(), 1);
}

TEST_F(DriveStartup, ALateAnswerTakesNoStateBackThatWasLostBefore) {
  silence(1, State::kOff);
  ASSERT_EQ(drive.replies_lost(), 1);
  drive.enter(State::kConfiguring, 0.0, 0.0);
  cycle(State::kConfiguring, true);
  CanFrame answer;
  motor.handle(drive.next_frame(State::kConfiguring, 0.0, true), &answer);
  drive.receive_late(State::kConfiguring, answer);
  EXPECT_EQ(drive.replies_lost(), 1);
}

TEST_F(DriveStartup, ALossIsTakenBackOnce) {
  drive.begin_cycle();
  drive.receive(State::kOn, DamiaoReply{kEnabled, 0.0, 0.0, 0.0}.frame());
  close(State::kOn);
  drive.begin_cycle();
  close(State::kOn);
  ASSERT_EQ(drive.replies_lost(), 1);
  drive.enter(State::kConfiguring, 0.0, 0.0);
  for (int i = 0; i < 2; ++i) {
    drive.begin_cycle();
    drive.receive_late(State::kConfiguring, kDisabledAtZero.frame());
    close(State::kConfiguring);
  }
  EXPECT_EQ(drive.replies_lost(), 0);
}

TEST_F(DriveStartup, ForgetsTheAngle) {
  drive.begin_cycle();
  drive.receive(State::kOn, DamiaoReply{kEnabled, 0.0, 0.0, 0.0}.frame());
  close(State::kOn);
  drive.enter(State::kConfiguring, 0.0, 0.0);
  drive.begin_cycle();
  drive.receive(State::kConfiguring, DamiaoReply{testing::kDisabled, 2.0, 0.0, 0.0}.frame());
  EXPECT_NEAR(drive.link().theta(), 2.0, 1e-3);
}

TEST_F(DriveStartup, OffBeginsTheWatchdogsAfresh) {
  silence(3, State::kOn);
  ASSERT_TRUE(drive.lost());
  drive.enter(State::kOff, 0.0, 0.0);
  EXPECT_FALSE(drive.lost());
}

TEST_F(DriveStartup, AnyTemperatureOfAReplyFitsItsField) {
  motor.rotor_degC = 255;
  cycle(State::kOff, true);
  EXPECT_EQ(drive.warning().temperature_degC, 255);
}

}  // namespace
}  // namespace limber::test_drive_startup
