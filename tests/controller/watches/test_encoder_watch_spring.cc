// A stopped encoder of a joint with a spring and a torque sensor: the spring's torque changes,
// although neither end of it moves.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "controller/watches/encoder_watch.h"

namespace limber::controller::test_encoder_watch_spring {
namespace {

constexpr double kStood_s = EncoderWatch::kStood_s;
constexpr double kLimit_Nm = 200.0;  // of which 2 N m may be the sensor's error

using Change = std::function<void(JointConfig&)>;
void nothing(JointConfig&) {}

/// The watch of a joint that hangs still: its motor, which makes no torque, tells nothing.
class Joint {
 public:
  explicit Joint(const Change& change = nothing) : watch_(robot(change)) {
    state_.num_joints = 1;
    state_.theta[0] = 1.001;
    state_.q[0] = 1.0;
    step(0.0);
  }
  /// Whether it is found when the sensor reads `spring_Nm`, `dt_s` later.
  bool step(double spring_Nm, double dt_s = kStood_s) {
    state_.tau[0] = spring_Nm;
    return watch_.stopped(state_, {VectorJ::Zero(1), VectorJ::Zero(1), MatrixJ::Identity(1, 1)},
                          dt_s) == 0;
  }
  joint_state_t& state() { return state_; }

 private:
  static Robot robot(const Change& change) {
    Robot robot;
    JointConfig joint;
    joint.torque_limit_Nm = kLimit_Nm;
    joint.velocity_limit = 100.0;
    joint.transmission.kind = TransmissionKind::kElastic;
    joint.transmission.spring.stiffness_Nm_per_rad = 1000.0;
    joint.drive.counts_per_turn = 1 << 20;
    joint.link_encoder = {.present = true, .bits = 20, .errors = {}};
    joint.torque_sensor.present = true;
    change(joint);
    robot.joints.push_back(joint);
    return robot;
  }

  EncoderWatch watch_;
  joint_state_t state_{};
};

/// A change of a little less than `bound_Nm` may be, one of a little more may not. In the time that
/// it must last 0.2 % of it are taken for drift.
void expect_bound(double bound_Nm, const Change& change = nothing) {
  const auto found = [&](double change_Nm) {
    Joint joint(change);
    joint.step(5.0);
    EXPECT_FALSE(joint.step(5.0 + change_Nm)) << "it must last";
    return joint.step(5.0 + change_Nm);
  };
  for (const double bound : {bound_Nm, -bound_Nm}) {
    EXPECT_FALSE(found(bound * 0.995)) << bound;
    EXPECT_TRUE(found(bound * 1.005)) << bound;
  }
}

TEST(EncoderWatchSpring, ATorqueThatChangesBetweenStandingEncoders) { expect_bound(2.0); }

TEST(EncoderWatchSpring, WithinSixTimesTheSensorsNoiseAndItsResolution) {
  expect_bound(3.25, [](JointConfig& joint) {
    joint.torque_sensor.noise_Nm = 0.5;
    joint.torque_sensor.resolution_Nm = 0.25;
  });
}

TEST(EncoderWatchSpring, WithinFourCountsOfBothEncoders) {
  // 2 pi (2^-8 + 2^-9) rad 1000 N m/rad
  expect_bound(4.0 * 2.0 * std::numbers::pi * 3.0 / 512.0 * 1000.0, [](JointConfig& joint) {
    joint.drive.counts_per_turn = 256;
    joint.link_encoder.bits = 9;
  });
}

TEST(EncoderWatchSpring, WhatTheSensorIsLateWithDoesNotCount) {
  Joint joint;
  EXPECT_FALSE(joint.step(50.0)) << "a filter arrives";
  EXPECT_FALSE(joint.step(50.0));
  EXPECT_FALSE(joint.step(50.0));
  EXPECT_FALSE(joint.step(0.0));
  EXPECT_TRUE(joint.step(0.0)) << "but it left again";
}

TEST(EncoderWatchSpring, ItMustLast) {
  Joint joint;
  joint.step(0.0);
  const double dt_s = kStood_s / 2.0;
  EXPECT_FALSE(joint.step(3.0, dt_s));
  EXPECT_FALSE(joint.step(3.0, dt_s));
  EXPECT_FALSE(joint.step(1.0, dt_s)) << "a spike";
  EXPECT_FALSE(joint.step(-3.0, dt_s));
  EXPECT_FALSE(joint.step(-3.0, dt_s));
  EXPECT_TRUE(joint.step(-3.0, dt_s));
}

TEST(EncoderWatchSpring, OneReadingAfterAGapIsNone) {
  Joint joint;
  EXPECT_FALSE(joint.step(10.0, 5.0 * kStood_s));
  EXPECT_FALSE(joint.step(0.0));
  joint.step(10.0);
  EXPECT_TRUE(joint.step(10.0)) << "the torque was 0 when it came to rest";
}

TEST(EncoderWatchSpring, TheBoundItselfIsAllowed) {
  Joint joint;
  joint.step(0.0);
  EXPECT_FALSE(joint.step(2.0));
  EXPECT_FALSE(joint.step(2.01)) << "the first beyond it";
  EXPECT_TRUE(joint.step(2.02));
}

TEST(EncoderWatchSpring, AfterALongGapTheSensorsValueCounts) {
  Joint joint;
  joint.step(0.0);
  joint.step(1.9, 2.0 * EncoderWatch::kDrift_s);
  for (int k = 0; k < 3; ++k) EXPECT_FALSE(joint.step(0.0)) << "1.9 N m less";
}

TEST(EncoderWatchSpring, ASensorMayDrift) {
  Joint joint;
  joint.step(0.0);
  // By 0.8 of the bound in the time it is forgotten in, five times; lag: 0.8 (1 - exp(-t / 5 s)).
  for (int k = 1; k <= 2500; ++k) EXPECT_FALSE(joint.step(0.8 * 2.0 * k / 500.0)) << k;
  // Beside that lag of 1.6 N m, 0.3 N m more are within the bound, 0.5 N m are not.
  const double drifted = 0.8 * 2.0 * 5.0;
  for (int k = 0; k < 3; ++k) EXPECT_FALSE(joint.step(drifted + 0.3));
  EXPECT_FALSE(joint.step(drifted + 0.5));
  EXPECT_TRUE(joint.step(drifted + 0.5));
}

TEST(EncoderWatchSpring, AnyReadingThatMovesBeginsAnew) {
  for (double* (*reading)(joint_state_t&) : {+[](joint_state_t& state) { return &state.theta[0]; },
                                             +[](joint_state_t& state) { return &state.q[0]; }}) {
    Joint joint;
    for (int k = 1; k < 20; ++k) {
      *reading(joint.state()) += 1e-6;
      EXPECT_FALSE(joint.step(10.0 * k)) << "it follows the spring";
    }
  }
}

TEST(EncoderWatchSpring, OnlyWithAllOfIt) {
  for (const Change& change : {
           Change([](JointConfig& joint) { joint.link_encoder.present = false; }),
           Change([](JointConfig& joint) { joint.torque_sensor.present = false; }),
           Change([](JointConfig& joint) { joint.transmission.kind = TransmissionKind::kRigid; }),
           Change([](JointConfig& joint) {
             joint.transmission.kind = TransmissionKind::kAntagonistic;
           }),
           Change(
               [](JointConfig& joint) { joint.transmission.spring.law = SpringLaw::kQuadratic; }),
       }) {
    Joint joint(change);
    joint.step(0.0);
    for (int k = 0; k < 5; ++k) EXPECT_FALSE(joint.step(1e3));
  }
}

}  // namespace
}  // namespace limber::controller::test_encoder_watch_spring
