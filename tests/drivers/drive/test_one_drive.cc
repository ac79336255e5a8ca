// One drive through its states: what it forgets, what it counts, and what it begins afresh.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/drivers/drive/damiao_reply.h"
#include "tests/drivers/drive/drive_cycles.h"

namespace limber::test_one_drive {
namespace {

using testing::DamiaoReply;
using testing::kEnabled;
using State = DriveState;

constexpr double kTorqueCount = 20.0 / 4095.0;
constexpr double kStepCount = kTorqueCount + 60.0 / 4095.0;  // and damping by the speed's count

class OneDrive : public ::testing::Test, protected testing::DriveCycles {
 protected:
  OneDrive() : DriveCycles(testing::test_robot(1).joints[0]) {}

  void cycles(int count, State state, const DamiaoReply& reply) {
    for (int i = 0; i < count; ++i) cycle(state, {reply.frame()});
  }
  /// N m, of a torque command's field.
  static double torque_of(const CanFrame& frame) {
    return testing::raw_command(frame).t * kTorqueCount - 10.0;
  }

  DamiaoReply standing{kEnabled, 0.0, 0.0, 0.0};
  DamiaoReply pulling{kEnabled, 0.0, 0.0, 9.0};
};

// 500 N m/s at 1 kHz are 0.5 N m a cycle.
TEST_F(OneDrive, FallbackGoesAtTheJointsTorqueRate) {
  cycles(1, State::kOn, standing);
  drive.enter(State::kFallback, 6.0, 0.0);
  EXPECT_NEAR(torque_of(drive.next_frame(State::kFallback, 0.0, true)), 5.5, kStepCount);
  EXPECT_NEAR(torque_of(drive.next_frame(State::kFallback, 0.0, true)), 5.0, kStepCount);
}

// Nobody knows whether the angle stands wrongly or the velocity: neither is held or damped by.
TEST_F(OneDrive, FallbackUsesNoMotionThatContradictsItself) {
  cycles(1, State::kOn, standing);
  drive.enter(State::kFallback, 2.0, 2.0);
  cycles(100, State::kFallback, standing);
  const auto held = testing::raw_command(drive.next_frame(State::kFallback, 0.0, false));
  EXPECT_GT(held.kp, 0);
  EXPECT_GT(held.kd, 0);
  cycles(100, State::kFallback, {kEnabled, 0.0, 15.0, 0.0});
  ASSERT_EQ(drive.contradiction(), Contradiction::kVelocity);
  const CanFrame frame = drive.next_frame(State::kFallback, 0.0, false);
  EXPECT_EQ(testing::raw_command(frame).kp, 0);
  EXPECT_EQ(testing::raw_command(frame).kd, 0);
  EXPECT_NEAR(torque_of(frame), 2.0, kTorqueCount) << "the torque stays";
}

TEST_F(OneDrive, FeedbackIsWatchedWhileThereIsPowerAndForgottenWithIt) {
  for (State powered : {State::kOn, State::kFallback, State::kDamp}) {
    cycles(150, powered, pulling);
    EXPECT_EQ(drive.contradiction(), Contradiction::kTorque) << static_cast<int>(powered);
    cycles(1, State::kOff, pulling);
    EXPECT_EQ(drive.contradiction(), Contradiction::kNone) << static_cast<int>(powered);
  }
  cycles(200, State::kFault, pulling);
  EXPECT_EQ(drive.contradiction(), Contradiction::kNone);
}

// 5 b = 10 cycles with a doubled reply within a second; several in one cycle count once.
TEST_F(OneDrive, RepliesThatAreDoubledInTenCyclesAreTooMany) {
  const CanFrame frame = standing.frame();
  cycles(1, State::kOn, standing);
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(drive.often_invalid()) << i;
    cycle(State::kOn, {frame, frame, frame, frame});
  }
  EXPECT_TRUE(drive.often_invalid());
  EXPECT_EQ(drive.replies_invalid(), 30);
  drive.acknowledge();
  for (int i = 0; i < 9; ++i) cycle(State::kOn, {frame, frame});
  EXPECT_FALSE(drive.often_invalid()) << "counted afresh";
  cycle(State::kOn, {frame, frame});
  EXPECT_TRUE(drive.often_invalid());
}

TEST_F(OneDrive, ALateReplyIsNoLoss) {
  cycles(3, State::kOn, standing);
  for (int i = 0; i < 20; ++i) {
    cycle(State::kOn, {});
    drive.begin_cycle();
    drive.receive_late(State::kOn, standing.frame());
    drive.receive(State::kOn, standing.frame());
    drive.close_cycle(State::kOn, number++, 0.0);
  }
  EXPECT_FALSE(drive.lost());
  EXPECT_EQ(drive.replies_late(), 20);
  EXPECT_EQ(drive.replies_lost(), 0);
}

TEST_F(OneDrive, ALateReplyToAnAnsweredCycleTakesNothingBack) {
  cycle(State::kOn, {});
  cycles(2, State::kOn, standing);
  ASSERT_EQ(drive.replies_lost(), 1);
  drive.begin_cycle();
  drive.receive_late(State::kOn, standing.frame());
  EXPECT_EQ(drive.replies_lost(), 1);
}

// An angle that the joint cannot have reached, at which it stays.
class OneDriveJumps : public OneDrive {
 protected:
  void silence(int count, State state) {
    for (int i = 0; i < count; ++i) cycle(state, {});
  }
  bool taken(State state) {
    cycle(state, {DamiaoReply{kEnabled, 2.0, 0.0, 0.0}.frame()});
    return std::abs(drive.link().theta() - 2.0) < 1e-3;
  }
};

TEST_F(OneDriveJumps, AreTakenOfADriveThatIsGivenUpAndLost) {
  for (State state : {State::kFallback, State::kDamp}) {
    drive.acknowledge();
    cycle(State::kOff, {standing.frame()});
    silence(3, state);
    ASSERT_TRUE(drive.lost());
    EXPECT_TRUE(taken(state)) << static_cast<int>(state);
    EXPECT_TRUE(drive.link().jumped());
    drive.acknowledge();
    EXPECT_FALSE(drive.link().jumped());
  }
}

TEST_F(OneDriveJumps, AreNotTakenWhileItIsOn) {
  cycles(1, State::kOn, standing);
  silence(5, State::kOn);
  ASSERT_TRUE(drive.lost());
  EXPECT_FALSE(taken(State::kOn));
}

TEST_F(OneDriveJumps, AreNotTakenBeforeItIsLost) {
  cycles(1, State::kFallback, standing);
  silence(5, State::kFallback);
  drive.acknowledge();
  EXPECT_FALSE(taken(State::kFallback));
}

// Two cycles are bridged: in the third the joint is still expected near.
TEST_F(OneDriveJumps, AreNotTakenWithinWhatIsBridged) {
  cycles(1, State::kFallback, standing);
  silence(3, State::kFallback);
  cycles(1, State::kFallback, standing);
  silence(2, State::kFallback);
  ASSERT_TRUE(drive.lost());
  EXPECT_FALSE(taken(State::kFallback));
  EXPECT_TRUE(taken(State::kFallback)) << "the next one";
}

TEST_F(OneDriveJumps, WithoutPowerALateAngleIsTakenAsItComes) {
  cycles(1, State::kOff, standing);
  cycle(State::kOff, {});
  drive.begin_cycle();
  drive.receive_late(State::kOff, DamiaoReply{testing::kDisabled, 2.0, 0.0, 0.0}.frame());
  EXPECT_NEAR(drive.link().theta(), 2.0, 1e-3);
}

TEST_F(OneDrive, TemperaturesFitTheirField) {
  cycles(1, State::kOn, standing);
  EXPECT_EQ(drive.warning().temperature_degC, 35);
  EXPECT_FALSE(drive.warning().any());
}

}  // namespace
}  // namespace limber::test_one_drive
