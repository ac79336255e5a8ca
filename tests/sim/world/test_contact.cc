// Contacts, wall and end stops by their equations: they push, and never pull.
#include <gtest/gtest.h>

#include "common/contact_law.h"
#include "sim/joints/end_stop.h"
#include "sim/world/wall.h"
#include "tests/sim/test_arms.h"

namespace limber::sim::test_contact {
namespace {

Wall wall_at_half_a_metre() {
  Wall wall;
  wall.point = Eigen::Vector3d(0.5, 0.3, -0.2);
  wall.normal = Eigen::Vector3d(-1.0, 0.0, 0.0);
  wall.stiffness = 2000.0;
  wall.damping = 40.0;
  return wall;
}

TEST(Wall, PushesAlongItsNormalByDepthAndSpeed) {
  const Wall wall = wall_at_half_a_metre();
  // 10 mm deep, 0.1 m/s further in: 20 N + 4 N towards free space; sliding along costs nothing.
  const Eigen::Vector3d F = wall.force({0.51, 7.0, 7.0}, {0.1, 3.0, -3.0});
  EXPECT_NEAR(F.x(), -24.0, 1e-9);
  EXPECT_EQ(F.y(), 0.0);
  EXPECT_EQ(F.z(), 0.0);
}

TEST(Wall, NeverPulls) {
  const Wall wall = wall_at_half_a_metre();
  EXPECT_TRUE(wall.force({0.49, 0.3, -0.2}, {-1.0, 0.0, 0.0}).isZero(0.0));
  EXPECT_TRUE(wall.force({0.51, 0.3, -0.2}, {-0.6, 0.0, 0.0}).isZero(0.0));  // 20 - 24 N
  EXPECT_NEAR(wall.force({0.51, 0.3, -0.2}, {-0.4, 0.0, 0.0}).x(), -4.0, 1e-9);
  EXPECT_TRUE(Wall().force({9.0, 9.0, -9.0}, Eigen::Vector3d::Zero()).isZero(0.0));
}

TEST(Wall, IsNoHarderThanTheStepCanCarry) {
  Wall wall = wall_at_half_a_metre();
  wall.limit_to(1.0 / 0.02, 0.01);  // a tip of 20 g at 10 ms: k <= 200, b <= 1
  EXPECT_NEAR(wall.force({0.51, 0.0, 0.0}, {0.1, 0.0, 0.0}).x(), -(2.0 + 0.1), 1e-9);
  wall.limit_to(0.0, 0.01);  // a tip that cannot move that way carries any wall
  EXPECT_NEAR(wall.force({0.51, 0.0, 0.0}, {0.1, 0.0, 0.0}).x(), -24.0, 1e-9);
}

TEST(Contact, HuntCrossleyByHand) {
  const Eigen::Vector3d n = Eigen::Vector3d(1.0, 2.0, 2.0) / 3.0;
  const Eigen::Vector3d p0(0.1, 0.2, 0.3);
  // 40 mm deep, 0.5 m/s inwards: 1000 * 0.008 * (1 + 0.4 * 0.5) = 9.6 N.
  const Approach in(p0 - 0.04 * n + Eigen::Vector3d(2.0, -1.0, 0.0), -0.5 * n, p0, n);
  EXPECT_NEAR(in.depth, 0.04, 1e-15);
  EXPECT_NEAR(in.speed, -0.5, 1e-15);
  EXPECT_NEAR(hunt_crossley(in, 1000.0, 0.4), 9.6, 1e-12);
  const Approach out(p0 - 0.04 * n, 3.0 * n, p0, n);
  EXPECT_EQ(hunt_crossley(out, 1000.0, 0.4), 0.0) << "never pulls";
  EXPECT_EQ(kelvin_voigt(out, 1000.0, 20.0), 0.0);
  EXPECT_NEAR(kelvin_voigt(out, 1000.0, 10.0), 10.0, 1e-12);
  const Approach outside(p0 + 1e-9 * n, -3.0 * n, p0, n);
  EXPECT_EQ(hunt_crossley(outside, 1000.0, 0.4), 0.0);
  EXPECT_EQ(kelvin_voigt(outside, 1000.0, 10.0), 0.0);
}

// A ball that arrives at speed v leaves at e v: with F = k d^1.5 (1 - c v_n) the energy balance
// integrates to c (v + w) = log((1 + c v) / (1 - c w)) for the speed of departure w.
TEST(Contact, HuntCrossleyGivesBackWhatItsEquationSays) {
  constexpr double c = 0.3;
  constexpr double arrival = 1.0;
  constexpr double dt = 1e-6;
  double x = 0.0;
  double v = -arrival;
  do {
    const Approach at({x + 0.5 * dt * v, 0, 0}, {v, 0, 0}, Eigen::Vector3d::Zero(),
                      Eigen::Vector3d::UnitX());
    v += dt * hunt_crossley(at, 1e5, c) / 0.5;
    x += dt * v;
  } while (x < 0.0);
  EXPECT_NEAR(c * (arrival + v), std::log((1.0 + c * arrival) / (1.0 - c * v)), 1e-4);
  EXPECT_LT(v, 0.9);
}

TEST(EndStop, PushesBackBeyondEachLimitAndNeverPulls) {
  JointConfig joint = testing::joint_config(0, JointType::kRevolute, 0.01);
  joint.position_min = -1.0;
  joint.position_max = 2.0;
  joint.torque_limit_Nm = 7.0;  // k = 700 N m/rad, d = 3.5 N m s/rad
  const EndStop stop(joint);
  const double h = 0.001;
  EXPECT_EQ(stop.torque(1.99, 5.0, h), 0.0);
  EXPECT_EQ(stop.torque(-0.99, -5.0, h), 0.0);
  EXPECT_NEAR(stop.torque(2.01, 0.0, h), -7.0, 1e-9);
  EXPECT_NEAR(stop.torque(-1.01, 0.0, h), 7.0, 1e-9);
  // Going further in at 1 rad/s: the damper, and the spring at the end of the step.
  EXPECT_NEAR(stop.torque(2.01, 1.0, h), -(7.0 + 3.5 + 0.7), 1e-9);
  // Leaving faster than the spring would throw it.
  EXPECT_EQ(stop.torque(2.01, -5.0, h), 0.0);
  EXPECT_EQ(stop.torque(-1.01, 5.0, h), 0.0);
}

}  // namespace
}  // namespace limber::sim::test_contact
