// One CANopen drive as the driver sees it: targets that it ignores, states in several frames, and
// an encoder on the link.
#include <gtest/gtest.h>

#include "tests/drivers/drive/drive_cycles.h"
#include "tests/drivers/families/fake_cia402.h"

namespace limber::test_cia402_drive {
namespace {

using testing::cia402_robot;
using testing::DriveCycles;
using testing::FakeCia402;
using testing::kOperationEnabled;
using testing::kSwitchedOn;
using State = DriveState;

constexpr int kFollowing = 1 << 12;
constexpr int kIgnoring = kOperationEnabled & ~kFollowing;

/// A motor that answers every SYNC, and the frames it answers with.
struct Motor : FakeCia402 {
  using FakeCia402::FakeCia402;
  std::vector<CanFrame> state_frames(int statusword) {
    operational = true;
    set_status(statusword);
    CanFrame sync;
    sync.id = 0x080;
    return handle(sync);
  }
};

struct Bench : DriveCycles {
  explicit Bench(bool fd)
      : DriveCycles(cia402_robot(fd).joints[0], fd), motor(cia402_robot(fd).joints[0], fd) {}

  void cycles(int count, State state, int statusword) {
    for (int i = 0; i < count; ++i) cycle(state, motor.state_frames(statusword));
  }

  Motor motor;
};

TEST(Cia402DriveTest, ThreeIgnoredTargetsInARowAreTooMany) {
  Bench bench(true);
  bench.cycles(2, State::kOn, kIgnoring);
  EXPECT_FALSE(bench.drive.ignores_target());
  bench.cycles(1, State::kOn, kOperationEnabled);
  bench.cycles(2, State::kOn, kIgnoring);
  EXPECT_FALSE(bench.drive.ignores_target());
  bench.cycles(1, State::kOn, kIgnoring);
  EXPECT_TRUE(bench.drive.ignores_target());
  EXPECT_TRUE(bench.drive.failed());
}

TEST(Cia402DriveTest, TargetsIgnoredBeforePowerWasLostDoNotCount) {
  Bench bench(true);
  bench.cycles(2, State::kOn, kIgnoring);
  bench.cycles(1, State::kOff, kIgnoring);
  bench.cycles(1, State::kOn, kIgnoring);
  EXPECT_FALSE(bench.drive.ignores_target());
}

TEST(Cia402DriveTest, OnlyAnEnabledDriveIgnoresATarget) {
  Bench bench(true);
  bench.cycles(5, State::kOn, kSwitchedOn & ~kFollowing);
  EXPECT_FALSE(bench.drive.ignores_target());
  EXPECT_FALSE(bench.drive.link().ignores_target());
}

// A classic bus: the state comes in several frames. Until the last of them has come it is lost.
TEST(Cia402DriveTest, ALatePartTakesNoLossBack) {
  Bench bench(false);
  bench.cycles(1, State::kOn, kOperationEnabled);
  bench.cycle(State::kOn, {});
  ASSERT_EQ(bench.drive.replies_lost(), 1);
  const std::vector<CanFrame> late = bench.motor.state_frames(kOperationEnabled);
  ASSERT_GE(late.size(), 2U);
  bench.drive.begin_cycle();
  for (const CanFrame& part : late) {
    EXPECT_EQ(bench.drive.replies_lost(), 1);
    bench.drive.receive_late(State::kOn, part);
  }
  EXPECT_EQ(bench.drive.replies_lost(), 0);
}

// The driver closes the loop of a drive without gains, on states as old as are bridged: two cycles.
TEST(Cia402DriveTest, ASpringActsOnStatesThatAreBridged) {
  const JointConfig joint = cia402_robot().joints[0];
  Motor motor(joint);
  JointLink link(joint, true, 1e-3, 2);
  link.begin_cycle();
  ASSERT_TRUE(link.receive(motor.state_frames(kOperationEnabled)[0]));
  for (int age = 1; age <= 4; ++age) {
    link.begin_cycle();
    const CanFrame frame = link.command({0.1, 50.0, 0.0, 0.0});
    const bool pulls = frame.data[2] != 0 || frame.data[3] != 0;
    EXPECT_EQ(pulls, age <= 2) << age;
  }
}

/// Motor and link report what they are told to, one cycle a call.
struct LinkBench {
  explicit LinkBench(int bits) : joint(with_bits(bits)), motor(joint) {}

  static JointConfig with_bits(int bits) {
    JointConfig joint = cia402_robot().joints[1];
    joint.link_encoder.bits = bits;
    return joint;
  }
  void report(int link_counts, int link_counts_per_s) {
    motor.link_position = link_counts;
    motor.link_velocity = link_counts_per_s;
    link.begin_cycle();
    link.forget_angle();
    link.torque(0.0);
    for (const CanFrame& frame : motor.state_frames(kOperationEnabled)) link.receive(frame);
    watch.add(link, time_s);
    time_s += 1e-3;
  }

  JointConfig joint;
  Motor motor;
  JointLink link{joint, true, 1e-3, 2};
  FeedbackWatch watch{link};
  double time_s = 1.0;
};

TEST(LinkVelocityTest, IsHeldAgainstTheLinksAngle) {
  LinkBench bench(18);
  for (int i = 0; i < 200; ++i) bench.report(0, 0);
  EXPECT_EQ(bench.watch.found(), Contradiction::kNone);
  for (int i = 0; i < 200; ++i) bench.report(0, 1 << 18);  // 6.3 rad/s, and it stands
  EXPECT_EQ(bench.watch.found(), Contradiction::kLinkVelocity);
  bench.watch.reset();
  EXPECT_EQ(bench.watch.found(), Contradiction::kNone);
}

// 64 counts a turn, c = 0.0982 rad: at rest 0.08 rad + 2 c = 0.276 rad are allowed; 3 c = 0.295.
TEST(LinkVelocityTest, TwoOfTheLinkEncodersCountsAreAllowed) {
  for (const int counts : {2, -2, 3, -3}) {
    LinkBench bench(6);
    bench.report(0, 0);
    bench.report(counts, 0);
    EXPECT_EQ(bench.watch.found(),
              std::abs(counts) == 2 ? Contradiction::kNone : Contradiction::kLinkVelocity)
        << counts;
  }
}

TEST(LinkVelocityTest, WithoutALinkEncoderThereIsNone) {
  JointConfig joint = cia402_robot().joints[0];
  Motor motor(joint);
  JointLink link(joint, true, 1e-3, 2);
  FeedbackWatch watch(link);
  motor.velocity = 65536;  // a turn a second, and it stands
  for (int i = 0; i < 300; ++i) {
    link.begin_cycle();
    link.torque(0.0);
    link.receive(motor.state_frames(kOperationEnabled)[0]);
    watch.add(link, 1.0 + 1e-3 * i);
  }
  EXPECT_EQ(watch.found(), Contradiction::kVelocity) << "the motor's, and named so";
}

}  // namespace
}  // namespace limber::test_cia402_drive
