// Laws for joints with springs in the cycle, against the closed forms of one joint.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "controller/elastic/pair_inverse.h"
#include "controller/elastic/spring_law.h"
#include "controller/kinds/smooth_motion.h"
#include "tests/controller/law_bench.h"
#include "tests/controller/one_joint.h"
#include "tests/controller/rig.h"

namespace limber::test_elastic_laws {
namespace {

using limber::testing::LawBench;
using limber::testing::one_joint;
using limber::testing::one_pair;
using limber::testing::OneJoint;
using limber::testing::Rig;
using Gains = compliance_gains_t;
using Status = controller_status_t;

constexpr double kLever = 0.5;        // m
constexpr float kFitDiagonal = 0.0F;  // words of stiffness_fit
constexpr float kFitJoint = 2.0F;

void place(Rig* rig, double q) {
  rig->plant.q[0] = q;
  rig->elastic->rest_at(rig->plant.q);
}

void run_law(Rig* rig, const Gains& gains) {
  const char* refused = rig->controller.on_gains(gains);
  ASSERT_EQ(refused, nullptr) << refused;
}

void move_to(Rig* rig, double q, double duration_s) {
  compliance_goal_t goal = rig->goal();
  goal.kind = compliance_goal_t::GOAL_JOINT;
  goal.q[0] = q;
  goal.duration_s = duration_s;
  ASSERT_EQ(rig->controller.on_goal(goal), nullptr);
}

// Stiffness of the link against a horizontal force at the tip, about q = 0.
double link_stiffness(Rig* rig, double force) {
  const double before = rig->plant.q[0];
  rig->plant.F_ext[0] = force;
  rig->run(6.0);
  const double q = rig->plant.q[0];
  rig->plant.F_ext.setZero();
  return force * kLever * std::cos(q) / (q - before);
}

// K_J = 60 and a weight of 20: K_P = 30 just holds the rod up, 50 is sufficient from anywhere.
TEST(TomeiInCycle, TakesWhatIsSufficient) {
  Rig rig(one_joint({.K_J = 60.0, .weight = 20.0, .K_q = 52.0}), "joint_pd");
  rig.run(0.2);
  Gains gains = rig.gains();
  gains.law = "tomei";
  gains.K_q[0] = 49.5;
  const char* refused = rig.controller.on_gains(gains);
  ASSERT_NE(refused, nullptr);
  EXPECT_NE(std::string(refused).find("N m/rad"), std::string::npos);
  gains.K_q[0] = 50.5;
  EXPECT_EQ(rig.controller.on_gains(gains), nullptr);
}

TEST(TomeiInCycle, HoldsTheRodUprightWithTheSeriesStiffnessLessTheWeight) {
  Rig rig(one_joint({.K_J = 60.0, .weight = 20.0, .K_q = 52.0}), "tomei");
  place(&rig, 0.2);
  rig.to_active();
  move_to(&rig, 2.8, 3.0);
  rig.run(12.0);
  EXPECT_NEAR(rig.plant.q[0], 2.8, 1e-3);
  Rig hanging(one_joint({.weight = 15.0}), "tomei");
  place(&hanging, 0.0);
  hanging.to_active();
  hanging.run(1.0);
  EXPECT_NEAR(link_stiffness(&hanging, 8.0), 1000.0 / 3.0 + 15.0, 0.005 * 348.0);
}

// Motor friction moves the rest position by tau_f / ((1 + K_T) K_q).
TEST(FullStateInCycle, DividesFrictionByTheTorqueGain) {
  double offset[2];
  for (const int K_T : {0, 1}) {
    Rig rig(one_joint({.weight = 0.0}), "full_state");
    place(&rig, 0.0);
    rig.to_active();
    Gains gains = rig.gains();
    set_parameter("torque_gain", {static_cast<float>(K_T)}, &gains);
    run_law(&rig, gains);
    rig.run(2.0);
    const double before = rig.elastic->theta[0];
    rig.elastic->tau_f[0] = 3.0;
    rig.run(4.0);
    offset[K_T] = before - rig.elastic->theta[0];
    EXPECT_LT(std::abs(rig.plant.v[0]), 1e-5);
  }
  EXPECT_NEAR(offset[0], 3.0 / 500.0, 1e-5);
  EXPECT_NEAR(offset[1], 3.0 / 1000.0, 1e-5);
}

// 1 N m accelerates the link with M + B / (1 + K_q / K_J).
TEST(DeflectionPdInCycle, IsAnInertia) {
  Rig rig(one_joint({.weight = 0.0}), "deflection_pd");
  place(&rig, 0.0);
  rig.to_active();
  Gains gains = rig.gains();
  gains.K_q[0] = 3000.0;
  run_law(&rig, gains);
  rig.run(1.0);
  rig.plant.F_ext[0] = 2.0;
  rig.run(0.2);
  const double before = rig.plant.v[0];
  rig.run(0.2);
  EXPECT_NEAR((rig.plant.v[0] - before) / 0.2, 1.0 / (0.5 + 0.2 / 4.0), 0.01 / 0.55);
}

// 0.5 rad in 0.5 s through a spring of 300 N m/rad, in continuous time.
TEST(Flatness, FollowsThroughTheSpring) {
  const OneJoint p{.K_J = 300.0, .D_J = 0.0, .weight = 5.0, .K_q = 100.0};
  LawBench bench(one_joint(p), "flatness");
  controller::SmoothMotion<VectorJ> motion(VectorJ::Zero(1));
  motion.start(VectorJ::Zero(1), VectorJ::Constant(1, 0.5), 0.5);
  double q = 0.0, v = 0.0, theta = 0.0, theta_dot = 0.0, error = 0.0;
  constexpr double h = 2e-5;
  bench.start(VectorJ::Zero(1), VectorJ::Zero(1));
  for (int i = 0; i < 35000; ++i) {
    motion.advance(h);
    bench.goal.q_d = motion.x;
    bench.goal.v_d = motion.v;
    bench.goal.a_d = motion.a;
    bench.goal.smooth = &motion;
    bench.state.theta[0] = theta;
    bench.state.theta_dot[0] = theta_dot;
    const double tau = bench.at(VectorJ::Constant(1, q), VectorJ::Constant(1, v)).tau()[0];
    const double spring = p.K_J * (theta - q);
    v += h * (spring - p.weight * std::sin(q)) / p.M;
    theta_dot += h * (tau - spring) / p.B;
    q += h * v;
    theta += h * theta_dot;
    error = std::max(error, std::abs(q - motion.x[0]));
  }
  EXPECT_LT(error, 1e-3);
  EXPECT_NEAR(q, 0.5, 2e-4);
}

TEST(PairInverse, OfQuadraticSprings) {
  const controller::SpringPair pair{{.law = SpringLaw::kQuadratic, .k2_Nm_per_rad2 = 400.0}};
  EXPECT_NEAR(controller::pair_deflection(pair, 0.15, 6.0), 6.0 / 120.0, 1e-12);
  EXPECT_NEAR(controller::least_preload(pair, -18.0), 120.0 / 800.0, 1e-12);
  EXPECT_NEAR(controller::pair_preload(pair, 160.0, 6.0, 1.0), 0.2, 1e-9);
  EXPECT_NEAR(controller::pair_preload(pair, 60.0, 18.0, 1.0), 0.15, 1e-9) << "both taut";
  EXPECT_NEAR(controller::pair_preload(pair, 1e4, 6.0, 0.5), 0.5, 1e-9);
}

TEST(PairInverse, OfOtherSprings) {
  for (const SpringConfig& spring :
       {SpringConfig{.law = SpringLaw::kExponential, .force_Nm = 2.0, .rate_per_rad = 6.0},
        SpringConfig{
            .law = SpringLaw::kCubic, .stiffness_Nm_per_rad = 20.0, .k3_Nm_per_rad3 = 300.0},
        SpringConfig{.law = SpringLaw::kSinh, .force_Nm = 0.5, .rate_per_rad = 8.0}}) {
    const controller::SpringPair pair{spring};
    const double least = controller::least_preload(pair, 4.0);
    EXPECT_NEAR(pair.torque(least, least), 4.0, 1e-9);
    const double sigma =
        pair.stiffness(1.5 * least, controller::pair_deflection(pair, 1.5 * least, 4.0));
    const double c = controller::pair_preload(pair, sigma, 4.0, 3.0 * least);
    EXPECT_NEAR(c, 1.5 * least, 1e-9);
    const double x = controller::pair_deflection(pair, c, 4.0);
    EXPECT_NEAR(pair.torque(c, x), 4.0, 1e-9);
    const double slope = (pair.torque(c, x + 1e-6) - pair.torque(c, x - 1e-6)) / 2e-6;
    EXPECT_NEAR(slope, sigma, 1e-4 * sigma);
  }
}

TEST(SpringLaw, DeflectionUndoesTheTorque) {
  for (const SpringConfig& spring :
       {SpringConfig{.law = SpringLaw::kLinear, .stiffness_Nm_per_rad = 20.0},
        SpringConfig{.law = SpringLaw::kQuadratic, .k2_Nm_per_rad2 = 400.0},
        SpringConfig{.law = SpringLaw::kExponential, .force_Nm = 2.0, .rate_per_rad = 6.0},
        SpringConfig{
            .law = SpringLaw::kCubic, .stiffness_Nm_per_rad = 20.0, .k3_Nm_per_rad3 = 300.0},
        SpringConfig{.law = SpringLaw::kCubic, .stiffness_Nm_per_rad = 20.0},
        SpringConfig{.law = SpringLaw::kSinh, .force_Nm = 0.5, .rate_per_rad = 8.0}}) {
    for (const double d : {-0.7, -1e-3, 0.0, 1e-6, 0.02, 0.4, 1.5}) {
      const double tau = controller::spring_torque(spring, d);
      EXPECT_NEAR(controller::spring_deflection(spring, tau), d, 1e-13)
          << static_cast<int>(spring.law);
    }
  }
}

TEST(VariableStiffness, LinkMeetsTheSpringsAsked) {
  Rig rig(one_pair({.D_J = 3.0, .weight = 0.0, .B = 0.04, .K_q = 120.0}), "variable_stiffness");
  place(&rig, 0.0);
  rig.to_active();
  Gains gains = rig.gains();
  set_parameter("stiffness_fit", {kFitJoint}, &gains);
  run_law(&rig, gains);
  rig.run(3.0);
  EXPECT_NEAR(rig.elastic->c[0], 120.0 / 800.0, 1e-3);
  EXPECT_NEAR(rig.controller.status().law_outputs[0], 120.0, 1e-3);
  EXPECT_NEAR(link_stiffness(&rig, 8.0), 120.0, 0.01 * 120.0);
  set_parameter("stiffness_fit", {kFitDiagonal}, &gains);
  for (auto& row : gains.K_x) std::fill(std::begin(row), std::end(row), 0.0);
  gains.K_x[0][0] = 640.0;  // N/m at 0.5 m
  run_law(&rig, gains);
  rig.run(6.0);
  EXPECT_NEAR(rig.controller.status().law_outputs[0], 160.0, 0.5);
  EXPECT_NEAR(link_stiffness(&rig, 8.0), 160.0, 0.01 * 160.0);
}

// K l^2 + K_G with K_G = -p.F: the world pulls the tip outwards with F = 10 N at p = 0.5 m, which
// holds the link by itself with 5 N m/rad.
TEST(VariableStiffness, LeavesToTheLoadWhatTheLoadGives) {
  Rig rig(one_pair({.D_J = 3.0, .weight = 0.0, .B = 0.04, .K_q = 120.0}), "variable_stiffness");
  place(&rig, 0.0);
  rig.to_active();
  Gains gains = rig.gains();
  set_parameter("stiffness_fit", {kFitDiagonal}, &gains);
  for (auto& row : gains.K_x) std::fill(std::begin(row), std::end(row), 0.0);
  gains.K_x[0][0] = 640.0;
  run_law(&rig, gains);
  compliance_goal_t goal = rig.goal();
  goal.kind = compliance_goal_t::GOAL_WRENCH;
  goal.F_ff[1] = 10.0;
  ASSERT_EQ(rig.controller.on_goal(goal), nullptr);
  rig.plant.F_ext[1] = -10.0;
  rig.run(6.0);
  EXPECT_NEAR(rig.controller.status().law_outputs[0], 640.0 * kLever * kLever - 10.0 * kLever, 0.5);
}

TEST(VariableStiffness, StaysStiffEnoughForTheWeight) {
  Rig rig(one_pair({.D_J = 3.0, .weight = 18.0, .B = 0.04, .K_q = 60.0}), "variable_stiffness");
  place(&rig, 1.5);
  rig.to_active();
  Gains gains = rig.gains();
  set_parameter("stiffness_fit", {kFitJoint}, &gains);
  run_law(&rig, gains);
  rig.run(4.0);
  const double tau = 18.0 * std::sin(rig.plant.q[0]);
  EXPECT_NEAR(rig.controller.status().law_outputs[0], std::sqrt(800.0 * tau), 1.5);
}

TEST(DitherOnSprings, IsRefused) {
  Rig rig(one_joint({}), "joint_pd");
  rig.to_active();
  Gains gains = rig.gains();
  gains.friction_compensation = Gains::FRICTION_DITHER;
  const Refusal refusal = rig.controller.on_gains(gains);
  ASSERT_TRUE(refusal);
  EXPECT_NE(std::string(refusal.reason).find("shake the springs"), std::string::npos);
}

// The estimate rises as 1 - exp(-L t) and takes the friction off the joint.
TEST(FrictionObserverInCycle, TakesFrictionOffTheMotor) {
  Rig rig(one_joint({.weight = 0.0}), "joint_pd");
  place(&rig, 0.0);
  rig.to_active();
  Gains gains = rig.gains();
  gains.friction_compensation = Gains::FRICTION_OBSERVER;
  gains.friction_observer_gain_per_s = 50.0F;
  gains.friction_share = 1.0F;
  run_law(&rig, gains);
  rig.run(2.0);
  const double before = rig.plant.q[0];
  rig.elastic->tau_f[0] = 3.0;
  rig.run(0.020);
  EXPECT_NEAR(rig.controller.status().tau_friction[0], 3.0 * (1.0 - std::exp(-1.0)), 0.15);
  rig.run(3.0);
  EXPECT_NEAR(rig.controller.status().tau_friction[0], 3.0, 1e-3);
  EXPECT_NEAR(rig.plant.q[0], before, 1e-5);
}

// By the torque sensors: the motors' friction is not in it.
TEST(MomentumObserverInCycle, SeesTheContactNotTheMotorsFriction) {
  Rig rig(one_joint({.weight = 5.0}), "joint_pd");
  rig.to_active();
  Gains gains = rig.gains();
  gains.contact = Gains::CONTACT_JOINT_TORQUE;
  run_law(&rig, gains);
  rig.elastic->tau_f[0] = 3.0;
  rig.plant.F_ext[0] = 4.0;
  rig.run(4.0);
  const double expected = 4.0 * kLever * std::cos(rig.plant.q[0]);
  EXPECT_NEAR(rig.controller.status().tau_ext[0], expected, 0.01 * expected);
}

}  // namespace
}  // namespace limber::test_elastic_laws
