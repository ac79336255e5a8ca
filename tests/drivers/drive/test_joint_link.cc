// One joint's end of the bus: bytes, signs, offsets, the mean of a quantised torque, impossible
// jumps.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "drivers/drive/joint_link.h"
#include "tests/drivers/fake_arm.h"

namespace limber::test_joint_link {
namespace {

using testing::raw_command;
using testing::RawCommand;

constexpr double kTorqueCount = 20.0 / 4095.0;  // range +-10 N m
constexpr double kAngleCount = 25.0 / 65535.0;  // range +-12.5 rad
constexpr double kSpeedCount = 60.0 / 4095.0;   // range +-30 rad/s

constexpr int kBridged = 2;  // cycles

JointConfig plain_joint() { return testing::test_robot(1).joints[0]; }
/// Counts the other way round, zero at 0.3 rad of the drive.
JointConfig reversed_joint() { return testing::test_robot(2).joints[1]; }

CanFrame state_reply(int id_nibble, int error, int p, int v, int t) {
  CanFrame frame;
  frame.id = 0x11;
  frame.length = 8;
  const int bytes[8] = {error << 4 | id_nibble, p >> 8,  p & 255, v >> 4,
                        (v & 15) << 4 | t >> 8, t & 255, 30,      35};
  for (std::size_t i = 0; i < 8; ++i) frame.data[i] = static_cast<std::uint8_t>(bytes[i]);
  return frame;
}

int count_of_angle(double drive_angle) {  // as a truncating drive does it
  return static_cast<int>((drive_angle + 12.5) / kAngleCount);
}

TEST(JointLinkTest, TorqueFrameByteByByte) {
  JointLink link(plain_joint(), true, 1e-3, kBridged);
  // -1 N m: (10 - 1) / 20 * 4095 = 1842.75, rounded 1843 = 0x733. Angle 0: 32767.5, rounded 0x8000;
  // speed 0: 2047.5, rounded 0x800; no gains.
  const CanFrame frame = link.torque(-1.0);
  EXPECT_EQ(frame.id, 1U);
  EXPECT_FALSE(frame.extended);
  EXPECT_TRUE(frame.fd);
  EXPECT_EQ(frame.length, 8);
  const int expected[8] = {0x80, 0x00, 0x80, 0x00, 0x00, 0x00, 0x07, 0x33};
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(frame.data[i], expected[i]) << i;
}

TEST(JointLinkTest, SignAndOffsetLiveAtTheBusEdge) {
  JointLink link(reversed_joint(), true, 1e-3, kBridged);
  // Drive at 0.8 rad, 1.5 rad/s, 2 N m: the joint is at -(0.8 - 0.3), and turns and pulls
  // backwards.
  ASSERT_TRUE(
      link.receive(state_reply(2, 1, count_of_angle(0.8), static_cast<int>(31.5 / kSpeedCount),
                               static_cast<int>(12.0 / kTorqueCount))));
  EXPECT_NEAR(link.q(), -0.5, 0.5001 * kAngleCount);
  EXPECT_NEAR(link.v(), -1.5, 0.5001 * kSpeedCount);
  EXPECT_NEAR(link.tau(), -2.0, 0.5001 * kTorqueCount);
  EXPECT_NEAR(link.current_A(), -4.0, kTorqueCount);
  EXPECT_EQ(link.temperature_degC(), 35);
  EXPECT_TRUE(link.enabled());
  // +1 N m at the joint is -1 N m at the drive; the position field holds what was measured.
  const RawCommand raw = raw_command(link.torque(1.0));
  EXPECT_EQ(raw.t, 1843);
  EXPECT_NEAR(raw.p, count_of_angle(0.8), 1);
  // A hold at joint angle 0.2 is a hold at drive angle 0.1.
  EXPECT_NEAR(raw_command(link.command({0.2, 50.0, 1.0, 0.0})).p, count_of_angle(0.1), 1);
}

// 5 rad/s and 1 ms: a rigid joint's angle steps by 7.5 mrad at most. A torque that grows by 500 N
// m/s winds up a spring of 200 N m/rad at 2.5 rad/s more; two motors may be twice as fast as the
// link.
TEST(JointLinkTest, AMotorThatWindsUpASpringIsFasterThanItsLink) {
  JointConfig elastic = plain_joint();
  elastic.transmission.kind = TransmissionKind::kElastic;
  elastic.transmission.spring.stiffness_Nm_per_rad = 200.0;
  JointConfig sinh = elastic;
  sinh.transmission.spring = {.law = SpringLaw::kSinh, .force_Nm = 20.0, .rate_per_rad = 10.0};
  JointConfig pair = plain_joint();
  pair.transmission.kind = TransmissionKind::kAntagonistic;
  pair.has_antagonist = true;
  for (const auto& [joint, most] : {std::pair{plain_joint(), 7.5e-3}, std::pair{elastic, 11.25e-3},
                                    std::pair{sinh, 11.25e-3}, std::pair{pair, 15e-3}}) {
    for (const bool beyond : {false, true}) {
      JointLink link(joint, true, 1e-3, kBridged);
      link.begin_cycle();
      ASSERT_TRUE(link.receive(state_reply(1, 1, count_of_angle(1.0), 2047, 2047)));
      link.begin_cycle();
      const double step = most + (beyond ? 4.0 : 0.0) * kAngleCount;
      EXPECT_EQ(link.receive(state_reply(1, 1, count_of_angle(1.0 + step), 2047, 2047)), !beyond)
          << most;
    }
  }
}

TEST(JointLinkTest, HalfACountMakesTruncatedRepliesRightOnAverage) {
  JointLink link(plain_joint(), true, 1e-3, kBridged);
  double error = 0.0;
  const int samples = 997;
  for (int i = 0; i < samples; ++i) {
    const double angle = 1.0 + kAngleCount * i / samples * 7.0;
    link.forget_angle();
    link.begin_cycle();
    ASSERT_TRUE(link.receive(state_reply(1, 0, count_of_angle(angle), 2047, 2047)));
    error += (link.q() - angle) / samples;
  }
  EXPECT_NEAR(error, 0.0, 0.01 * kAngleCount);  // without the half count: -0.5 counts
  EXPECT_EQ(link.v(), 0.0);                     // a resting drive's 0x7FF is exactly zero
  EXPECT_EQ(link.tau(), 0.0);
}

TEST(JointLinkTest, MeanTorqueIsExactAlthoughEachFrameIsNot) {
  for (double wanted : {0.0, 0.001, -0.0007, 0.0024, 1.2345, -3.21, 7.99}) {
    for (const JointConfig& joint : {plain_joint(), reversed_joint()}) {
      JointLink link(joint, true, 1e-3, kBridged);
      double sum = 0.0;
      const int cycles = 2000;
      for (int i = 0; i < cycles; ++i) {
        const int raw = raw_command(link.torque(wanted)).t;
        const double sent = joint.drive.sign * (-10.0 + raw * kTorqueCount);
        EXPECT_NEAR(sent, wanted, 1.0001 * kTorqueCount);
        sum += sent;
      }
      // The sum is never further off than half a count.
      EXPECT_NEAR(sum, cycles * wanted, 0.5001 * kTorqueCount) << wanted;
    }
  }
}

TEST(JointLinkTest, RoundingNeverCarriesATorqueOverTheLimit) {
  JointLink link(plain_joint(), true, 1e-3, kBridged);  // limit 8 N m; the range reaches 10
  for (double wanted : {8.0, -8.0, 7.9999, -7.9999, 8.5, -1e9}) {
    for (int i = 0; i < 50; ++i) {
      const double sent = -10.0 + raw_command(link.torque(wanted)).t * kTorqueCount;
      EXPECT_LE(std::abs(sent), 8.0);
      EXPECT_GE(std::abs(sent), 8.0 - 2.0 * kTorqueCount);
    }
  }
  // What could not be sent is not owed: back at zero, the mean is zero again.
  double sum = 0.0;
  for (int i = 0; i < 100; ++i) sum += -10.0 + raw_command(link.torque(0.0)).t * kTorqueCount;
  EXPECT_NEAR(sum, 0.0, 1.0001 * kTorqueCount);
}

TEST(JointLinkTest, WhatIsNotFiniteBecomesAStateRequest) {
  for (double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    for (const JointCommand& command : {JointCommand{0, 0, 0, bad}, JointCommand{bad, 1, 1, 0},
                                        JointCommand{0, bad, 0, 0}, JointCommand{0, 0, bad, 0}}) {
      JointLink link(plain_joint(), true, 1e-3, kBridged);
      const CanFrame frame = link.command(command);
      EXPECT_EQ(frame.id, 0x7FFU);
      EXPECT_EQ(frame.data[2], 0xCC);
      // And the next good command is not affected.
      EXPECT_NEAR(-10.0 + raw_command(link.torque(1.0)).t * kTorqueCount, 1.0, 2 * kTorqueCount);
    }
  }
}

TEST(JointLinkTest, TorqueAppliedCountsTheDriveSideSpringAndDamper) {
  for (const JointConfig& joint : {plain_joint(), reversed_joint()}) {
    JointLink link(joint, true, 1e-3, kBridged);
    const double sign = joint.drive.sign;
    const int id = static_cast<int>(joint.drive.command_id);
    const CanFrame frame = link.command({0.5, 50.0, 2.0, 1.0});
    // The joint is at 0.2 rad and turns with 1 rad/s.
    ASSERT_TRUE(link.receive(state_reply(id, 1, count_of_angle(sign * 0.2 + joint.drive.offset_rad),
                                         static_cast<int>((sign + 30.0) / kSpeedCount), 2047)));
    EXPECT_EQ(raw_command(frame).kp, 410);   // 50 / 500 * 4095 = 409.5
    EXPECT_EQ(raw_command(frame).kd, 1638);  // 2 / 5 * 4095
    EXPECT_NEAR(link.tau_applied(), 50.0 * 0.3 - 2.0 * 1.0 + 1.0, 0.08);
  }
}

TEST(JointLinkTest, NoTorqueIsAppliedByRequestsOrToDisabledDrives) {
  JointLink link(plain_joint(), true, 1e-3, kBridged);
  (void)link.torque(3.0);
  ASSERT_TRUE(link.receive(state_reply(1, 0, 32767, 2047, 2047)));
  EXPECT_EQ(link.tau_applied(), 0.0);
  link.begin_cycle();
  (void)link.torque(3.0);
  ASSERT_TRUE(link.receive(state_reply(1, 1, 32767, 2047, 2047)));
  EXPECT_NEAR(link.tau_applied(), 3.0, kTorqueCount);
  (void)link.disable();
  EXPECT_EQ(link.tau_applied(), 0.0);
}

TEST(JointLinkTest, AnotherMotorsNumberAndSecondRepliesAreRefused) {
  JointLink link(plain_joint(), true, 1e-3, kBridged);
  EXPECT_FALSE(link.receive(state_reply(2, 1, 32767, 2047, 2047)));
  EXPECT_EQ(link.age_cycles(), JointLink::kNever);
  EXPECT_TRUE(link.receive(state_reply(1, 1, 32767, 2047, 2047)));
  EXPECT_FALSE(link.receive(state_reply(1, 1, 32767, 2047, 2047)));
  link.begin_cycle();
  EXPECT_TRUE(link.receive(state_reply(1, 1, 32767, 2047, 2047)));
  link.begin_cycle();
  CanFrame bad = state_reply(1, 1, 32767, 2047, 2047);
  bad.length = 7;
  EXPECT_FALSE(link.receive(bad));
  bad.length = 8;
  bad.remote = true;
  EXPECT_FALSE(link.receive(bad));
}

// 5 rad/s, 1 ms: 7.5 mrad = 19.66 counts for a cycle, and two counts for the encoder: 21 pass.
TEST(JointLinkTest, AnglesThatCannotBeAreRefused) {
  for (int gap = 1; gap <= 6; ++gap) {
    for (int direction : {1, -1}) {
      const int cycles = std::min(gap, 3);
      const int most = static_cast<int>(cycles * 7.5e-3 / kAngleCount + 2.0);
      for (int jump : {most, most + 1}) {
        JointLink link(plain_joint(), true, 1e-3, kBridged);
        link.begin_cycle();
        ASSERT_TRUE(link.receive(state_reply(1, 1, 32767, 2047, 2047)));
        for (int i = 0; i < gap; ++i) link.begin_cycle();
        EXPECT_EQ(link.receive(state_reply(1, 1, 32767 + direction * jump, 2047, 2047)),
                  jump == most)
            << gap << " " << jump;
        EXPECT_EQ(link.fresh(), jump == most);
        link.forget_angle();
        link.begin_cycle();
        EXPECT_TRUE(link.receive(state_reply(1, 1, 40000, 2047, 2047)));
      }
    }
  }
}

TEST(JointLinkTest, EveryStatusButEnabledAndDisabledIsAnError) {
  for (int error = 0; error < 16; ++error) {
    JointLink link(plain_joint(), true, 1e-3, kBridged);
    EXPECT_FALSE(link.drive_error());
    ASSERT_TRUE(link.receive(state_reply(1, error, 32767, 2047, 2047)));
    EXPECT_EQ(link.enabled(), error == 1);
    EXPECT_EQ(link.drive_error(), error > 1);
  }
}

TEST(JointLinkTest, AgeCountsCyclesSinceTheLastReply) {
  JointLink link(plain_joint(), true, 1e-3, kBridged);
  link.begin_cycle();
  EXPECT_EQ(link.age_cycles(), JointLink::kNever);
  ASSERT_TRUE(link.receive(state_reply(1, 1, 32767, 2047, 2047)));
  EXPECT_TRUE(link.fresh());
  for (int age = 1; age < 5; ++age) {
    link.begin_cycle();
    EXPECT_EQ(link.age_cycles(), age);
    EXPECT_FALSE(link.fresh());
  }
}

constexpr double kTurn = 6.283185307179586;

JointConfig with_travel(JointConfig joint, double low, double high) {
  joint.position_min = low;
  joint.position_max = high;
  joint.drive.single_turn = true;
  return joint;
}

CanFrame standing_at(int id_nibble, double drive_angle) {
  return state_reply(id_nibble, 0, count_of_angle(drive_angle), 2048, 2048);
}

TEST(JointLinkTest, AWholeTurnIsTakenOutAndCommandsGoBackToTheDrivesAngle) {
  for (const int turns : {-1, 0, 1}) {
    JointLink link(with_travel(plain_joint(), -1.0, 3.0), true, 1e-3, kBridged);
    const double drive_angle = 2.5 - turns * kTurn;
    ASSERT_TRUE(link.receive(standing_at(1, drive_angle)));
    EXPECT_TRUE(link.turns().known);
    EXPECT_EQ(link.turns().turns, turns);
    EXPECT_NEAR(link.theta(), 2.5, kAngleCount);
    const RawCommand sent = raw_command(link.command({2.4, 10.0, 1.0, 0.0}));
    EXPECT_NEAR(sent.p, count_of_angle(drive_angle - 0.1), 2);
  }
}

TEST(JointLinkTest, ADriveThatCountsTheOtherWayRoundHasItsTurnsInTheJointsWay) {
  JointLink link(with_travel(reversed_joint(), -1.0, 3.0), true, 1e-3, kBridged);
  ASSERT_TRUE(link.receive(standing_at(2, 0.3 - 2.5 + kTurn)));  // zero at 0.3
  EXPECT_EQ(link.turns().turns, 1);
  EXPECT_NEAR(link.theta(), 2.5, kAngleCount);
}

TEST(JointLinkTest, NoAngleThatFitsStaysAsItIsAndTwoAreNotKnown) {
  JointLink none(with_travel(plain_joint(), -1.0, 1.0), true, 1e-3, kBridged);
  ASSERT_TRUE(none.receive(standing_at(1, 2.0)));
  EXPECT_TRUE(none.turns().known);
  EXPECT_NEAR(none.theta(), 2.0, kAngleCount);  // out of range, told as ever
  JointLink two(with_travel(plain_joint(), -3.2, 3.2), true, 1e-3, kBridged);
  ASSERT_TRUE(two.receive(standing_at(1, 3.15)));
  EXPECT_FALSE(two.turns().known);
  two.begin_cycle();
  two.forget_angle();
  ASSERT_TRUE(two.receive(standing_at(1, 2.0)));  // turned by hand to where one fits
  EXPECT_TRUE(two.turns().known);
}

TEST(JointLinkTest, JointsWithoutEndsAndDrivesThatKeepTheirTurnsAreLeftAlone) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  JointLink endless(with_travel(plain_joint(), -kNone, kNone), true, 1e-3, kBridged);
  ASSERT_TRUE(endless.receive(standing_at(1, 7.0)));
  EXPECT_NEAR(endless.theta(), 7.0, kAngleCount);
  JointConfig keeping = with_travel(plain_joint(), -1.0, 3.0);
  keeping.drive.single_turn = false;
  JointLink kept(keeping, true, 1e-3, kBridged);
  ASSERT_TRUE(kept.receive(standing_at(1, 7.0)));
  EXPECT_NEAR(kept.theta(), 7.0, kAngleCount);
}

// A drive that restarts while the arm moves comes back a turn off: impossible, until it is off.
TEST(JointLinkTest, TurnsAreFoundAgainOnceTheDriveIsOff) {
  JointLink link(with_travel(plain_joint(), -1.0, 4.0), true, 1e-3, kBridged);
  ASSERT_TRUE(link.receive(standing_at(1, 3.5)));
  link.begin_cycle();
  EXPECT_FALSE(link.receive(standing_at(1, 3.5 - kTurn)));
  EXPECT_NEAR(link.theta(), 3.5, kAngleCount);
  link.forget_angle();
  ASSERT_TRUE(link.receive(standing_at(1, 3.5 - kTurn)));
  EXPECT_EQ(link.turns().turns, 1);
  EXPECT_NEAR(link.theta(), 3.5, kAngleCount);
}

}  // namespace
}  // namespace limber::test_joint_link
