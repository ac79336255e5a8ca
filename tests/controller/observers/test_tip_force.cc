// From what a sensor at the tip reads to the contact wrench: poses whose answer is written down.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "controller/laws/registry.h"
#include "controller/observers/tip_force.h"
#include "tools/allocations/allocations.h"

namespace limber::controller::test_tip_force {
namespace {

constexpr double kHalfTurn = std::numbers::pi;
const Eigen::Vector3d kX = Eigen::Vector3d::UnitX();
const Eigen::Vector3d kY = Eigen::Vector3d::UnitY();
const Eigen::Vector3d kZ = Eigen::Vector3d::UnitZ();

Vector6 six(double a, double b, double c, double d, double e, double f) {
  Vector6 v;
  v << a, b, c, d, e, f;
  return v;
}

struct TipForceTest : ::testing::Test {
  TipForceTest() : terms(3) {
    robot.has_tip_sensor = true;
    message.sensor_state = joint_state_t::SENSOR_FRESH;
  }
  void turn_tip(double angle, const Eigen::Vector3d& axis) {
    terms.X_BT.Q = Eigen::AngleAxisd(angle, axis);
  }
  void turn_sensor(double angle, const Eigen::Vector3d& axis) {
    const Eigen::Quaterniond Q(Eigen::AngleAxisd(angle, axis));
    const double wxyz[] = {Q.w(), Q.x(), Q.y(), Q.z()};
    std::copy_n(wxyz, 4, robot.tip_sensor.quat_TS);
  }
  void read(const Vector6& F) { std::copy_n(F.data(), 6, message.F_sensor); }
  TipForce updated(const Vector6& A_BT = Vector6::Zero()) {
    TipForce force(robot);
    force.update(read_tip(message), terms, A_BT);
    return force;
  }
  void expect(const Vector6& F, const TipForce& force) {
    EXPECT_TRUE(force.valid());
    EXPECT_LT((force.F_ext() - F).cwiseAbs().maxCoeff(), 1e-12) << force.F_ext().transpose();
  }

  Robot robot;
  ArmTerms terms;
  joint_state_t message{};
};

TEST_F(TipForceTest, AlignedAtTheTipItIsTheReading) {
  read(six(1, 2, 3, 4, 5, 6));
  expect(six(1, 2, 3, 4, 5, 6), updated());
}

// The tip a quarter turn about base z, the sensor in it a quarter turn about tip x: sensor x, y, z
// point along base y, z, x.
TEST_F(TipForceTest, TurnsByTipAndSensor) {
  turn_tip(kHalfTurn / 2, kZ);
  turn_sensor(kHalfTurn / 2, kX);
  read(six(1, 2, 3, 4, 5, 6));
  expect(six(3, 1, 2, 6, 4, 5), updated());
}

// The sensor lies 0.1 m behind the tip along tip z, which points along base x: a force along base z
// at the tip reads as a moment about the sensor of 0.1 x cross z = -0.1 y.
TEST_F(TipForceTest, MovesTheMomentToTheTip) {
  turn_tip(kHalfTurn / 2, kY);  // tip z to base x, tip x to base -z
  robot.tip_sensor.p_TS[2] = -0.1;
  // Force 10 N along base z = -10 N along tip x; moment -1 N m about base y = tip y.
  read(six(-10, 0, 0, 0, -1, 0));
  expect(six(0, 0, 10, 0, 0, 0), updated());
}

// A tool of 2 kg hangs 0.05 m along sensor x. The sensor feels 2 * 9.81 N downwards and, with x
// level, 0.05 x cross -19.62 z = +0.981 y.
TEST_F(TipForceTest, AToolAtRestIsNoContact) {
  robot.tip_sensor.tool_mass_kg = 2.0;
  robot.tip_sensor.p_SC[0] = 0.05;
  read(six(0, 0, -19.62, 0, 0.981, 0));
  expect(Vector6::Zero(), updated());

  // Upside down (half a turn about x): weight along sensor +z, moment -0.981 about sensor y.
  turn_tip(kHalfTurn, kX);
  read(six(0, 0, 19.62, 0, -0.981, 0));
  expect(Vector6::Zero(), updated());
}

// In free fall a tool weighs nothing; on a table that turns at 3 rad/s about base z, with the mass
// 0.2 m out on x, it pulls outwards with m omega^2 r = 2 * 9 * 0.2 = 3.6 N.
TEST_F(TipForceTest, AToolThatIsAcceleratedIsNoContact) {
  robot.tip_sensor.tool_mass_kg = 2.0;
  robot.tip_sensor.p_SC[0] = 0.2;
  terms.V_BT = six(0, 0, 0, 0, 0, 3);
  read(six(3.6, 0, 0, 0, 0, 0));
  expect(Vector6::Zero(), updated(six(0, 0, -9.81, 0, 0, 0)));
}

// Spun up about z with 5 rad/s^2 and pushed along x with 4 m/s^2: a_C = (4, 5 * 0.2, 0), force -m
// a, moment 0.2 x cross -2 y = -0.4 z.
TEST_F(TipForceTest, TheToolsInertiaIsTakenOut) {
  robot.gravity[2] = 0.0;
  robot.tip_sensor.tool_mass_kg = 2.0;
  robot.tip_sensor.p_SC[0] = 0.2;
  read(six(-8, -2, 0, 0, 0, -0.4));
  expect(Vector6::Zero(), updated(six(4, 0, 0, 0, 0, 5)));
}

TEST_F(TipForceTest, BiasIsTakenOutInSensorAxes) {
  turn_tip(kHalfTurn / 2, kZ);
  robot.tip_sensor.bias = {0.5, 0, 0, 0, 0, 0.1};
  read(six(1.5, 0, 0, 0, 0, 0.3));
  expect(six(0, 1, 0, 0, 0, 0.2), updated());
}

TEST_F(TipForceTest, TareHoldsInEveryPose) {
  robot.tip_sensor.tool_mass_kg = 1.0;
  robot.tip_sensor.p_TS[0] = 0.3;
  robot.gravity[2] = -10.0;
  const Vector6 unknown_bias = six(0.3, -0.2, 0.1, 0.03, 0.02, -0.01);
  read(unknown_bias + six(0, 0, -10, 0, 0, 0));
  TipForce force = updated();
  ASSERT_TRUE(force.tare());
  expect(Vector6::Zero(), force);

  turn_tip(kHalfTurn, kY);  // the weight along sensor +z, the bias as before
  read(unknown_bias + six(0, 0, 10, 0, 0, 0));
  force.update(read_tip(message), terms, Vector6::Zero());
  expect(Vector6::Zero(), force);
}

TEST_F(TipForceTest, OldReadingsHoldAndErrorsDoNot) {
  read(six(1, 2, 3, 4, 5, 6));
  message.sensor_state = joint_state_t::SENSOR_STALE;
  message.sensor_age_cycles = 2;
  TipForce force = updated();
  expect(six(1, 2, 3, 4, 5, 6), force);
  EXPECT_EQ(force.age_cycles(), 2);
  for (const std::int8_t state : {joint_state_t::SENSOR_ERROR, joint_state_t::SENSOR_NONE}) {
    message.sensor_state = state;
    force.update(read_tip(message), terms, Vector6::Zero());
    EXPECT_FALSE(force.valid());
    EXPECT_EQ(force.F_ext(), Vector6::Zero());
    EXPECT_FALSE(force.tare());
  }
}

TEST_F(TipForceTest, NanDoesNotPass) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < 6; ++i) {
    read(Vector6::Zero());
    message.F_sensor[i] = nan;
    const TipForce force = updated();
    EXPECT_FALSE(force.valid()) << i;
    EXPECT_EQ(force.F_ext(), Vector6::Zero()) << i;
  }
}

TEST_F(TipForceTest, TheRegistryKnowsIt) {
  EXPECT_EQ(sensors_of(robot) & sensors::kTipForceSensor, 0U);  // no joints
  robot.joints.resize(1);
  EXPECT_NE(sensors_of(robot) & sensors::kTipForceSensor, 0U);
  robot.has_tip_sensor = false;
  EXPECT_EQ(sensors_of(robot) & sensors::kTipForceSensor, 0U);
}

TEST_F(TipForceTest, NeverAllocates) {
  TipForce force(robot);
  const std::int64_t before = allocations();
  force.update(read_tip(message), terms, Vector6::Zero());
  force.tare();
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace limber::controller::test_tip_force
