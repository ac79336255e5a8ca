// Wall and end stops by their equations: they push, and never pull.
#include <gtest/gtest.h>

#include "sim/joints/end_stop.h"
#include "sim/wall.h"
#include "tests/sim/test_arms.h"

namespace limber::sim {
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
}  // namespace limber::sim
