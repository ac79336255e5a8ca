// The cycle at arms with springs in their joints: what the link meets, and that it stays quiet.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/config_error.h"
#include "tests/controller/one_joint.h"
#include "tests/controller/rig.h"

namespace limber::test_elastic_arm {
namespace {

using limber::testing::Rig;
using Gains = compliance_gains_t;
using Status = controller_status_t;

// Link 0.5, motor 0.2 kg m^2, spring 1000 N m/rad.
LoadedRobot one_joint(bool sensors) { return limber::testing::one_joint({.sensors = sensors}); }

double deflection_by(Rig* rig, double force) {
  const double before = rig->plant.q[0];
  rig->plant.F_ext[0] = force;
  rig->run(4.0);
  rig->plant.F_ext.setZero();
  return rig->plant.q[0] - before;
}

struct Side {
  const char* name;
  std::int8_t position;
  double stiffness;  // of the link, N m/rad, at K_q = 500 and K_J = 1000
};

class OneJoint : public ::testing::TestWithParam<Side> {};

// Near q = 0 the rod hangs; its weight is carried wherever it is, but the motor's side carries it
// at theta instead of q.
TEST_P(OneJoint, LinkMeetsTheStiffnessOfItsSide) {
  Rig rig(one_joint(true), "joint_pd");
  rig.plant.q[0] = 0.0;
  rig.elastic->rest_at(rig.plant.q);
  rig.to_active();
  Gains gains = rig.gains();
  gains.position_feedback = GetParam().position;
  gains.joint_damping_ratio = 0.3;
  ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
  rig.run(2.0);
  const double force = 8.0;  // 0.5 m below the axis: 4 N m
  const double angle = deflection_by(&rig, force);
  const double tau = force * 0.5 * std::cos(rig.plant.q[0]);
  const double weight = 2.0 * 9.81 * 0.5;
  // The gradient of the weight that the springs carry, where it is not carried at the link itself.
  const double alpha = GetParam().position == Gains::POSITION_MOTOR ? weight : 0.0;
  const double motor = 500.0 - alpha;
  const double expected = GetParam().position == Gains::POSITION_MOTOR
                              ? motor * 1000.0 / (motor + 1000.0) + alpha
                              : GetParam().stiffness;
  EXPECT_NEAR(tau / angle, expected, 0.005 * expected);
  EXPECT_NEAR(GetParam().stiffness, expected, 0.03 * expected);
}
INSTANTIATE_TEST_SUITE_P(Sides, OneJoint,
                         ::testing::Values(Side{"link", Gains::POSITION_LINK, 500.0},
                                           Side{"motor", Gains::POSITION_MOTOR, 1000.0 / 3.0},
                                           Side{"static", Gains::POSITION_STATIC, 500.0}),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(ElasticArm, RefusesWhatItsSpringsCannotGive) {
  Rig rig(one_joint(false), "joint_pd");
  rig.run(0.2);
  Gains gains = rig.gains();
  gains.position_feedback = Gains::POSITION_LINK;
  EXPECT_NE(rig.controller.on_gains(gains), nullptr) << "no link encoder";
  gains.position_feedback = Gains::POSITION_STATIC;
  EXPECT_EQ(rig.controller.on_gains(gains), nullptr);
  gains.K_q[0] = 901.0;
  EXPECT_NE(rig.controller.on_gains(gains), nullptr) << "stiffer than its spring";
  gains.position_feedback = Gains::POSITION_MOTOR;
  EXPECT_EQ(rig.controller.on_gains(gains), nullptr) << "in series with it";
  gains = rig.gains();
  gains.law = "computed_torque";
  EXPECT_EQ(rig.controller.on_gains(gains), nullptr);
  gains.position_feedback = Gains::POSITION_STATIC;
  EXPECT_NE(rig.controller.on_gains(gains), nullptr) << "no static form";
  LoadedRobot stiff = one_joint(false);
  stiff.robot.gains.K_q = {950.0};
  EXPECT_THROW(Rig(stiff, "joint_pd"), ConfigError);
}

// HOLD carries the arm where the drives took over: the link stays within what its oscillation and
// the blend from no torque leave.
// The tip is 0.5 m from the axis: K_x / 4 N m/rad and its moment's, of 1000.
TEST(ElasticArm, RefusesATipStifferThanItsSprings) {
  Rig rig(one_joint(true), "joint_pd");
  rig.plant.q[0] = 0.0;
  rig.elastic->rest_at(rig.plant.q);
  rig.to_active();
  Gains gains = rig.gains();
  gains.law = "cartesian_impedance";
  gains.K_x[5][5] = 100.0F;
  gains.K_x[0][0] = 3190.0F;
  EXPECT_EQ(rig.controller.on_gains(gains), nullptr);
  gains.K_x[0][0] = 3210.0F;
  EXPECT_NE(rig.controller.on_gains(gains), nullptr);
  gains.position_feedback = Gains::POSITION_MOTOR;
  EXPECT_EQ(rig.controller.on_gains(gains), nullptr);
}

// Accepted where the axis of K_x is across the joint's motion, and brought to where it is along it.
TEST(ElasticArm, TipGetsNoStifferThanItsSpringsOnTheWay) {
  Rig rig(one_joint(true), "joint_pd");
  rig.plant.q[0] = 1.3;
  rig.elastic->rest_at(rig.plant.q);
  rig.to_active();
  Gains gains = rig.gains();
  gains.law = "cartesian_impedance";
  for (int i = 1; i < 6; ++i) gains.K_x[i][i] = 0.0F;
  gains.K_x[0][0] = 4400.0F;  // 79 N m/rad here, 1100 hanging
  gains.spring_force_N = 1000.0F;
  ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
  rig.run(0.6);
  EXPECT_EQ(rig.controller.status().limits & Status::LIMIT_STIFFNESS, 0);
  compliance_goal_t goal = rig.goal();
  goal.offset[0] = -0.5 * std::sin(1.3);
  goal.duration_s = 1.0;
  ASSERT_EQ(rig.controller.on_goal(goal), nullptr);
  rig.run(8.0);  // so close to its spring the motor damps little
  EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE);
  EXPECT_NE(rig.controller.status().limits & Status::LIMIT_STIFFNESS, 0);
  EXPECT_NEAR(rig.plant.q[0], 0.0, 1e-3);
  EXPECT_LT(std::abs(rig.plant.v[0]), 1e-3);
  const double force = 8.0;
  EXPECT_NEAR(force * 0.5 / deflection_by(&rig, force), 900.0, 10.0);
}

// Half of the spring's stiffness: what the closed form for a motor without mass allows, 0.21, is
// little more with this rotor. A twentieth of it is damped as asked.
TEST(ElasticArm, WarnsOfDampingThatItsSpringsDoNotAllow) {
  Rig rig(one_joint(true), "joint_pd");
  rig.run(0.2);
  Gains gains = rig.gains();
  gains.joint_damping_ratio = 0.7;
  gains.K_q[0] = 500.0;
  const Refusal hard = rig.controller.on_gains(gains);
  EXPECT_EQ(hard, nullptr);
  ASSERT_NE(hard.warning, nullptr);
  const std::string text = hard.warning;
  EXPECT_EQ(text.find("joint_damping_ratio is 0.7, 5 % of overshoot; against the joints' springs"),
            0U)
      << text;
  EXPECT_NE(text.find(" 0.27 is possible in this pose, 41 %"), std::string::npos) << text;
  gains.K_q[0] = 50.0;
  EXPECT_EQ(rig.controller.on_gains(gains).warning, nullptr);
  gains.K_q[0] = 500.0;
  gains.joint_damping_ratio = 0.25;
  EXPECT_EQ(rig.controller.on_gains(gains).warning, nullptr);
}

// Pushed and let go, the link swings through as the damping ratio says.
TEST(ElasticArm, LinkOvershootsAsAsked) {
  for (const auto& [position, K] :
       {std::pair{Gains::POSITION_MOTOR, 300.0F}, std::pair{Gains::POSITION_STATIC, 250.0F},
        std::pair{Gains::POSITION_LINK, 250.0F}}) {
    Rig rig(limber::testing::one_joint({.weight = 1e-3}), "joint_pd");
    rig.plant.q[0] = 0.0;
    rig.elastic->rest_at(rig.plant.q);
    rig.to_active();
    Gains gains = rig.gains();
    gains.position_feedback = position;
    gains.K_q[0] = K;
    gains.joint_damping_ratio = 0.3;
    ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
    rig.run(1.0);
    const double held = deflection_by(&rig, 8.0);
    double least = held;
    for (int i = 0; i < 1000; ++i) {
      rig.step();
      least = std::min(least, rig.plant.q[0]);
    }
    EXPECT_NEAR(-least / held, std::exp(-M_PI * 0.3 / std::sqrt(1.0 - 0.09)), 0.03) << +position;
  }
}

TEST(ElasticArm, HoldCarriesTheWeightExactly) {
  for (const bool sensors : {false, true}) {
    Rig rig(limber::testing::elastic_arm(sensors));
    rig.to_hold();
    rig.run(4.0);
    const VectorJ g = rig.plant.model.gravity(rig.plant.q);
    EXPECT_LT((rig.tau() - g).norm(), 2e-3 * g.norm() + 0.02) << sensors;
    EXPECT_LT(rig.plant.v.norm(), 1e-3);
    for (int i = 0; i < 7; ++i) {
      EXPECT_NEAR(rig.answer.tau_gravity[i], g[i], 0.02 * g.norm() + 0.02);
    }
  }
}

// A push that ends leaves a motion that dies out, on every side, stiff and soft; sampled at 1 kHz,
// the torque a period late.
struct Case {
  const char* law;
  std::int8_t position;
  double share;  // of the spring's stiffness
};

double fastest_tip(Rig* rig, double seconds) {
  double fastest = 0.0;
  for (int i = 0; i < static_cast<int>(1e3 * seconds); ++i) {
    rig->step();
    const Vector6 V = rig->plant.model.jacobian(rig->plant.q) * rig->plant.v;
    fastest = std::max(fastest, V.head<3>().norm());
  }
  return fastest;
}

class Quiet : public ::testing::TestWithParam<Case> {};

TEST_P(Quiet, PushDiesOut) {
  LoadedRobot robot = limber::testing::elastic_arm(false);
  for (std::size_t i = 0; i < 7; ++i) {
    robot.robot.gains.K_q[i] = GetParam().share * (i < 4 ? 843.0 : 250.0);
  }
  robot.robot.gains.D_null.assign(7, 5.0);  // what rotors of this size need at K_null = 5
  robot.robot.gains.K_x_translation_N_per_m = 400.0 * 4.0 * GetParam().share;
  robot.robot.gains.K_x_rotation_Nm_per_rad = 20.0 * 4.0 * GetParam().share;
  Rig rig(robot, GetParam().law);
  rig.to_active();
  Gains gains = rig.gains();
  gains.position_feedback = GetParam().position;
  ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
  rig.run(1.0);
  rig.plant.F_ext << 10, -8, 6, 0.5, 0.2, -0.4;
  rig.run(1.0);
  rig.plant.F_ext.setZero();
  const double largest = fastest_tip(&rig, 0.1);
  rig.run(1.5);
  EXPECT_LT(fastest_tip(&rig, 0.2), 0.02 * largest);
  EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE);
}
std::vector<Case> quiet_cases() {
  std::vector<Case> cases;
  for (const double share : {0.1, 0.25, 0.5}) {
    for (const char* law : {"joint_pd", "cartesian_impedance"}) {
      cases.push_back({law, Gains::POSITION_MOTOR, share});
      cases.push_back({law, Gains::POSITION_STATIC, share});
    }
  }
  return cases;
}
INSTANTIATE_TEST_SUITE_P(Laws, Quiet, ::testing::ValuesIn(quiet_cases()), [](const auto& tested) {
  return std::string(tested.param.law) + (tested.param.position == 2 ? "_motor_" : "_static_") +
         std::to_string(static_cast<int>(100 * tested.param.share));
});

TEST(AntagonisticArm, PreloadGoesToWhereItRests) {
  Rig rig(limber::testing::antagonistic_arm());
  rig.to_hold();
  rig.run(3.0);
  const VectorJ g = rig.plant.model.gravity(rig.plant.q);
  EXPECT_LT((rig.tau() - g).norm(), 2e-3 * g.norm() + 0.02);
  for (int i = 0; i < 7; ++i) {
    EXPECT_NEAR(rig.elastic->c[i], 0.3, 1e-3);
    const double x = g[i] / 240.0;
    EXPECT_NEAR(rig.answer.tau_preload[i], 400.0 * (0.09 + x * x), 0.05);
  }
  EXPECT_LT(rig.plant.v.norm(), 1e-3);
}

// Drives that come up have no torque yet, whatever their springs pull with: the gate counts from
// there, 2 N m a cycle of both motors.
TEST(AntagonisticArm, PreloadNeverJumps) {
  Rig rig(limber::testing::antagonistic_arm());
  rig.run(0.12);
  rig.request(mode_request_t::REQUEST_HOLD);
  double before = 0.0;
  double least = 1.0;
  for (int i = 0; i < 500; ++i) {
    rig.step();
    ASSERT_LE(std::abs(rig.answer.tau_preload[0] - before), 0.8 + 1e-9) << i;
    before = rig.answer.tau_preload[0];
    least = std::min(least, rig.elastic->c[0]);
  }
  EXPECT_GT(least, 0.1) << "of 0.15 that they were wound to, without a stand";
}

}  // namespace
}  // namespace limber::test_elastic_arm
