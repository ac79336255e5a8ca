// The shipped arms, and what robot.yaml makes of a URDF.
#include <gtest/gtest.h>

#include <cmath>

#include "robots/loader/load_robot.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "tests/robots/arm_terms.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"

namespace limber::test_load_robot {
namespace {

using testing::Terms;
using testing::terms_at;

/// Textbook dynamics of the planar arm, without the rotors: see the comments in their robot.urdf.
struct Planar {
  double a1, a2, l1, l2, m1, m2, I1, I2, motor2;

  Eigen::Matrix2d M(double q2) const {
    const double b22 = I2 + m2 * l2 * l2;
    const double b12 = b22 + m2 * a1 * l2 * std::cos(q2);
    const double b11 = I1 + m1 * l1 * l1 + I2 +
                       m2 * (a1 * a1 + l2 * l2 + 2 * a1 * l2 * std::cos(q2)) + motor2 * a1 * a1;
    return (Eigen::Matrix2d() << b11, b12, b12, b22).finished();
  }
  Eigen::Vector2d g(double q1, double q2) const {
    const double second = m2 * l2 * 9.81 * std::cos(q1 + q2);
    return {(m1 * l1 + motor2 * a1 + m2 * a1) * 9.81 * std::cos(q1) + second, second};
  }
};

void expect_planar(const LoadedRobot& arm, const Planar& closed) {
  const double poses[][2] = {{0, 0}, {-2.322, 0.074}, {-0.169, 2.086}, {1.378, -1.374}};
  for (const auto& q : poses) {
    const Terms terms = terms_at(arm, {q[0], q[1]});
    const double scale = closed.M(0.0).norm();
    EXPECT_LT((terms.M - closed.M(q[1])).norm(), 1e-13 * scale);
    EXPECT_LT((terms.g - closed.g(q[0], q[1])).norm(), 1e-12 * scale * 9.81);
    EXPECT_NEAR(terms.p_BT.x(), closed.a1 * std::cos(q[0]) + closed.a2 * std::cos(q[0] + q[1]),
                1e-14);
    EXPECT_NEAR(terms.p_BT.y(), closed.a1 * std::sin(q[0]) + closed.a2 * std::sin(q[0] + q[1]),
                1e-14);
  }
}

TEST(LoadRobot, Desktop2rHasItsClosedForm) {
  const LoadedRobot arm = load_robot("desktop2r");
  expect_planar(arm, {0.35, 0.3, 0.175, 0.15, 1.2, 0.8, 0.01225, 0.006, 0.3});
  // Golden figures of the closed form with rotors, at q = 0: b11 0.293568, b22 0.0258. The coupling
  // of rotor 2 with link 1 (1.8e-5 in b11) is what a reflected inertia leaves out.
  const Eigen::MatrixXd M = terms_at(arm, {0, 0}).M;
  EXPECT_NEAR(M(0, 0) + arm.robot.joints[0].drive.rotor_inertia_kgm2, 0.293568 - 1.8e-5, 1e-12);
  EXPECT_NEAR(M(1, 1) + arm.robot.joints[1].drive.rotor_inertia_kgm2, 0.0258, 1e-12);
  EXPECT_NEAR(terms_at(arm, {0, 0}).g[0], 7.01415, 1e-12);
}

constexpr Planar kThinRods = {0.5, 0.4, 0.25, 0.2, 4.0, 2.5, 1.0 / 12.0, 1.0 / 30.0, 0.0};

TEST(LoadRobot, Antagonist2rIsTwoThinRods) { expect_planar(load_robot("antagonist2r"), kThinRods); }

TEST(LoadRobot, Planar2rIsTwoThinRodsOnIdealDrives) {
  const LoadedRobot arm = load_robot("planar2r");
  expect_planar(arm, kThinRods);
  for (const JointConfig& joint : arm.robot.joints) {
    EXPECT_EQ(joint.drive.rotor_inertia_kgm2, 0.0);
    EXPECT_EQ(joint.friction.coulomb_Nm + joint.friction.viscous_Nms_per_rad, 0.0);
    EXPECT_EQ(joint.torque_limit_Nm, 150.0);
    EXPECT_GE(joint.torque_rate_limit_Nm_per_s / arm.robot.rate_hz, 100.0);
  }
}

// Stretched out the links' lengths add up: 0.1575 + 0.2025 + 0.2045 + 0.2155 + 0.1845 + 0.2155 +
// 0.081 + 0.045 to the flange.
TEST(LoadRobot, Ideal7IsTheArmOfItsTables) {
  const LoadedRobot arm = load_robot("ideal7");
  ASSERT_EQ(arm.robot.size(), 7);
  const Terms zero = terms_at(arm, std::vector<double>(7, 0.0));
  EXPECT_NEAR(zero.p_BT.z(), 1.306 + 0.1, 1e-12);
  EXPECT_NEAR(zero.p_BT.head<2>().norm(), 0.0, 1e-12);
  // A quarter turn of the shoulder: all masses beyond joint 2, at their heights above it.
  const double mass[] = {6.35, 3.5, 3.5, 3.5, 1.8, 1.2};
  const double height[] = {0.059,          0.2045 + 0.13, 0.42 + 0.067,
                           0.6045 + 0.076, 0.82 + 0.0006, 0.901 + 0.02};
  double moment = 0.0;
  for (int i = 0; i < 6; ++i) moment += mass[i] * height[i];
  const Terms level = terms_at(arm, {0.0, 1.5707963267948966, 0.0, 0.0, 0.0, 0.0, 0.0});
  EXPECT_NEAR(std::abs(level.g[1]), 9.81 * moment, 1e-9);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(arm.robot.joints[i].drive.command_id, 0x8001 + i);
    EXPECT_EQ(arm.robot.joints[i].drive.reply_id, 256 * (i + 1));
    EXPECT_EQ(arm.robot.joints[i].torque_limit_Nm, 300.0);
    EXPECT_EQ(arm.robot.joints[i].velocity_limit, 10.0);
  }
}

TEST(LoadRobot, TextbookArmHasItsClosedForm) {
  const double gravity[3] = {0.0, -9.81, 0.0};
  const LoadedRobot arm =
      load_urdf(source_path("tests/robots/data/siciliano.urdf"), "base", "tip", gravity);
  expect_planar(arm, {1, 1, 0.5, 0.5, 50, 50, 10, 10, 5});
  EXPECT_NEAR(terms_at(arm, {0, 0}).g[0], 1030.05, 1e-10);
}

TEST(LoadRobot, OpenarmIsTheArmOfItsTables) {
  const LoadedRobot arm = load_robot("openarm");
  ASSERT_EQ(arm.robot.size(), 7);
  EXPECT_EQ(arm.robot.gravity[2], -9.81);
  EXPECT_TRUE(arm.notes.empty());
  // Stretched out it hangs: the hand is below the shoulder by the lengths of the links.
  const Terms zero = terms_at(arm, std::vector<double>(7, 0.0));
  EXPECT_NEAR(zero.p_BT.z(), 0.698 - (0.06625 + 0.15375 + 0.0955 + 0.1205), 1e-5);
  EXPECT_NEAR(zero.p_BT.x(), 0.0, 1e-5);
  EXPECT_NEAR(zero.p_BT.y(), -0.031 - 0.0625 - 0.06 - 0.0205, 1e-5);
  const double peak[] = {40, 40, 27, 27, 7, 7, 7};
  const double reflected[] = {0.015795, 0.015795, 0.032, 0.032, 0.0018, 0.0018, 0.0018};
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(arm.robot.joints[i].torque_limit_Nm, peak[i]);
    EXPECT_NEAR(arm.robot.joints[i].drive.rotor_inertia_kgm2, reflected[i], 1e-15);
    EXPECT_EQ(arm.robot.joints[i].drive.command_id, i + 1);
    EXPECT_EQ(arm.robot.joints[i].drive.reply_id, i + 17);
  }
  EXPECT_EQ(arm.robot.joints[2].drive.range.velocity_rad_per_s, 10.0);
}

/// A pose to start from must leave the motors room and be away from the ends.
TEST(LoadRobot, ShippedHomesAreEasyToHold) {
  for (const char* name : {"openarm", "desktop2r", "planar2r", "ideal7", "testbench", "iiwa14",
                           "panda", "baxter", "antagonist2r", "antagonist7"}) {
    const LoadedRobot arm = load_robot(name);
    std::vector<double> home;
    for (const JointConfig& joint : arm.robot.joints) home.push_back(joint.home);
    const Terms terms = terms_at(arm, home);
    for (int i = 0; i < arm.robot.size(); ++i) {
      const JointConfig& joint = arm.robot.joints[static_cast<std::size_t>(i)];
      EXPECT_LT(std::abs(terms.g[i]), 0.5 * joint.torque_limit_Nm) << name << " " << joint.name;
      EXPECT_GT(joint.home - joint.position_min, 0.3) << name << " " << joint.name;
      EXPECT_GT(joint.position_max - joint.home, 0.3) << name << " " << joint.name;
    }
  }
}

TEST(LoadRobot, MoteusDrivesAreRead) {
  const Robot robot = load_robot(source_path("tests/robots/data/moteus")).robot;
  const DriveConfig& turn = robot.joints[0].drive;
  EXPECT_EQ(turn.protocol, &protocol_named("moteus"));
  EXPECT_EQ(turn.command_id, 0x8003U);
  EXPECT_EQ(turn.reply_id, 0x300U);
  EXPECT_EQ(turn.frames.command, 48);
  EXPECT_EQ(turn.frames.replies, std::vector<int>{32});
  EXPECT_NEAR(turn.range.kp_Nm_per_rad * 2.0 * M_PI, 400.0, 1e-9);
  EXPECT_NEAR(turn.range.kd_Nms_per_rad * 2.0 * M_PI, 20.0, 1e-9);
  EXPECT_EQ(turn.timeout_torque_Nm, 3.0);
  EXPECT_EQ(turn.warning_temperature_degC, 50.0);
  EXPECT_EQ(turn.limit_temperature_degC, 65.0);
  EXPECT_EQ(turn.counts_per_turn, 4294967296.0);
  EXPECT_EQ(robot.joints[0].torque_limit_Nm, 15.0);  // peak; the URDF says 20
  EXPECT_EQ(robot.joints[0].velocity_limit, 5.0);    // URDF: frames have no end
  EXPECT_EQ(robot.joints[1].drive.protocol, &protocol_named("damiao_mit"));
  EXPECT_EQ(robot.joints[1].drive.frames.command, 8);
  EXPECT_EQ(robot.joints[2].drive.command_id, 0x800CU);
  EXPECT_EQ(robot.joints[2].drive.reply_id, 0xC00U);
}

class ArmOfTheTests : public ::testing::Test {
 protected:
  const Robot robot_ = load_robot(source_path("tests/robots/data/arm")).robot;
};

TEST_F(ArmOfTheTests, TightestLimitHolds) {
  const auto& joints = robot_.joints;
  EXPECT_EQ(joints[0].position_min, -2.0);      // URDF
  EXPECT_EQ(joints[0].position_max, 2.0);       // robot.yaml; the URDF says 2.5
  EXPECT_EQ(joints[0].velocity_limit, 4.0);     // range of the drive; the URDF says 5
  EXPECT_EQ(joints[0].torque_limit_Nm, 12.0);   // robot.yaml; motor 15, URDF 20
  EXPECT_EQ(joints[1].velocity_limit, 0.4);     // robot.yaml; URDF 0.5
  EXPECT_EQ(joints[1].torque_limit_Nm, 100.0);  // URDF; motor 200
  EXPECT_EQ(joints[2].torque_limit_Nm, 4.0);    // URDF; motor 15
  EXPECT_EQ(joints[2].position_max, 3.0);       // robot.yaml for a continuous joint
}

TEST_F(ArmOfTheTests, TorqueRateIsGentleUnlessRaised) {
  EXPECT_EQ(robot_.joints[0].torque_rate_limit_Nm_per_s, 5000.0);  // asked for
  EXPECT_EQ(robot_.joints[1].torque_rate_limit_Nm_per_s, 1000.0);  // 100 N in 20 ms is too fast
  EXPECT_EQ(robot_.joints[2].torque_rate_limit_Nm_per_s, 200.0);   // 4 N m in 20 ms
}

TEST_F(ArmOfTheTests, MotorIsSeenThroughItsGear) {
  const DriveConfig& drive = robot_.joints[0].drive;
  EXPECT_NEAR(drive.rotor_inertia_kgm2, 81 * 0.0002, 1e-15);
  EXPECT_NEAR(drive.torque_constant_Nm_per_A, 9 * 0.15, 1e-15);
  // Shorted phases: a rotor at w makes the q-axis voltage (2/3) kt w, which drives (2/3) kt w / R
  // against it. Dissipation check: the power tau w equals 3/2 R i^2.
  const double w = 9.0;  // joint at 1 rad/s
  const double current = 2.0 / 3.0 * 0.15 * w / 0.2;
  EXPECT_NEAR(drive.short_circuit_damping_Nms, 9 * 0.15 * current, 1e-12);
  EXPECT_NEAR(drive.short_circuit_damping_Nms * 1.0, 1.5 * 0.2 * current * current, 1e-12);
}

TEST_F(ArmOfTheTests, DriveSideIsRead) {
  const DriveConfig& turn = robot_.joints[0].drive;
  EXPECT_EQ(turn.sign, -1.0);
  EXPECT_EQ(turn.offset_rad, 0.7);
  EXPECT_EQ(turn.watchdog_s, 0.02);
  EXPECT_EQ(turn.warning_temperature_degC, 80.0);
  EXPECT_EQ(turn.limit_temperature_degC, 90.0);
  EXPECT_EQ(turn.watchdog_reaction, NodeWatchdogReaction::kOff);
  EXPECT_EQ(turn.hold_kp_Nm_per_rad, 50.0);
  EXPECT_EQ(robot_.joints[1].drive.sign, 1.0);
  EXPECT_EQ(robot_.joints[2].drive.bus, 1);
  EXPECT_EQ(robot_.buses[1].can, "socketcan:can1");
  EXPECT_FALSE(robot_.buses[1].fd);
  EXPECT_EQ(robot_.joints[0].friction.static_Nm, 0.3);
  EXPECT_EQ(robot_.joints[1].friction.static_Nm, 2.0);  // as coulomb where nothing is said
  EXPECT_EQ(robot_.joints[2].friction.coulomb_Nm, 0.0);
  EXPECT_EQ(robot_.gains.K_null, (std::vector<double>{2, 2, 2}));
}

}  // namespace
}  // namespace limber::test_load_robot
