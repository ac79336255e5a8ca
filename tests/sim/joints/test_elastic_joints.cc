// Joints with springs against the closed forms of two masses and of antagonistic pairs, and their
// energy book.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/config_error.h"
#include "sim/plant/arm_plant.h"
#include "sim/plant/start_state.h"
#include "tests/sim/test_arms.h"

namespace limber::sim::test_elastic_joints {
namespace {

constexpr double kStep = 250e-6;
constexpr double kLink = 0.5;
constexpr double kRotor = 0.2;
constexpr double kReduced = kLink * kRotor / (kLink + kRotor);

class ElasticJoint : public ::testing::TestWithParam<Integrator> {
 protected:
  void make(const LoadedRobot& robot, bool friction = false) {
    forces_ = std::make_unique<ForceModel>(robot.robot, friction);
    plant_ = make_arm_plant(GetParam(), build_arm_model(robot));
  }
  void step(double h) { plant_->step(forces_.get(), h, 0); }
  void set_torque(int motor, double torque) {
    forces_->drives[motor] = {};
    forces_->drives[motor].tau_ff = torque;
    forces_->drives[motor].limit = std::abs(torque);
  }
  double energy() const {
    return plant_->kinetic_energy() + plant_->arm().potential_energy() +
           forces_->elastic_energy(plant_->state());
  }
  bool exact() const { return GetParam() == Integrator::kReference; }
  const ArmState& x() const { return plant_->state(); }
  double stretch() const { return x().theta[0] - x().q[0]; }
  void displace_motor(double theta) {
    ArmState state = x();
    state.theta[0] += theta;
    plant_->set_state(state);
  }
  std::unique_ptr<ForceModel> forces_;
  std::unique_ptr<ArmPlant> plant_;
};
INSTANTIATE_TEST_SUITE_P(Each, ElasticJoint,
                         ::testing::Values(Integrator::kOde, Integrator::kReference));

LoadedRobot two_masses(double stiffness, double damping) {
  LoadedRobot robot = testing::one_joint(kLink, kRotor, 0.0);
  testing::make_elastic(&robot.robot.joints[0], stiffness, damping);
  return robot;
}

// d'' + D/mu d' + K/mu d = 0, mu = M B / (M + B), while (M q + B theta) / (M + B) stays.
TEST_P(ElasticJoint, FreeVibrationIsThatOfTwoMasses) {
  for (const double damping : {0.0, 2.0}) {
    const double K = 5000.0;
    make(two_masses(K, damping));
    displace_motor(0.01);
    const double omega = std::sqrt(K / kReduced);
    const double zeta = damping / (2.0 * std::sqrt(K * kReduced));
    const double omega_d = omega * std::sqrt(1.0 - zeta * zeta);
    double worst = 0.0;
    for (int k = 1; k <= 800; ++k) {
      step(kStep);
      const double t = k * kStep;
      const double d = 0.01 * std::exp(-zeta * omega * t) *
                       (std::cos(omega_d * t) + zeta * omega / omega_d * std::sin(omega_d * t));
      worst = std::max(worst, std::abs(stretch() - d));
      const double centre = kLink * x().q[0] + kRotor * x().theta[0];
      ASSERT_NEAR(centre, kRotor * 0.01, 1e-9);
    }
    // ODE: half a step's motion, h omega / 2 of the amplitude; the reference: (h omega)^4 / 120 a
    // radian.
    EXPECT_LT(worst, 0.01 * (exact() ? 5e-5 : 0.03)) << damping;
  }
}

// The centre of mass moves with tau / (M + B); the spring swings about tau mu / (B K).
TEST_P(ElasticJoint, TorqueStepOfTheMotorShakesTheLink) {
  const double K = 5000.0;
  const double tau = 3.0;
  make(two_masses(K, 0.0));
  set_torque(0, tau);
  const double omega = std::sqrt(K / kReduced);
  const double rest = tau * kReduced / (kRotor * K);
  double worst = 0.0;
  for (int k = 1; k <= 800; ++k) {
    step(kStep);
    const double t = k * kStep;
    const double centre = 0.5 * tau / (kLink + kRotor) * t * t;
    const double d = rest * (1.0 - std::cos(omega * t));
    const double q = centre - kRotor / (kLink + kRotor) * d;
    worst = std::max(worst, std::abs(x().q[0] - q));
    ASSERT_NEAR(forces_->spring_torque(x(), 0), K * stretch(), 1e-9);
  }
  EXPECT_LT(worst, exact() ? 1e-8 : 3e-4);
}

// Stiffer and stiffer the joint becomes the rigid one: M + B.
TEST_P(ElasticJoint, AStiffSpringIsARigidJoint) {
  LoadedRobot robot = testing::one_joint(kLink, kRotor, 9.81);
  make(robot);
  for (int k = 0; k < 400; ++k) step(kStep);
  const double rigid = plant_->q()[0];
  testing::make_elastic(&robot.robot.joints[0], 1e7, 10.0);
  make(robot);
  for (int k = 0; k < 400; ++k) step(kStep);
  EXPECT_NEAR(plant_->q()[0], rigid, 2e-5);
}

// Quadratic springs: sigma = 2 k2 c and tau = sigma (e - q), exactly, while both are taut.
TEST_P(ElasticJoint, AntagonisticPairSwingsAtItsPreloadsStiffness) {
  const double k2 = 400.0;
  for (const double c : {0.15, 0.45}) {
    LoadedRobot robot = testing::one_joint(kLink, kRotor, 0.0);
    testing::make_antagonistic(&robot.robot.joints[0], k2, c);
    make(robot);
    start_at(robot.robot, VectorJ::Zero(1), false, plant_.get());
    EXPECT_NEAR(forces_->joint_stiffness(x(), 0), 2.0 * k2 * c, 1e-9);
    // Drives that hold their motors as good as still.
    for (int motor : {0, 1}) forces_->drives[motor] = {1e7, 4e3, c, 0.0, 0.0, 1e9, 0.0};
    ArmState state = x();
    state.q[0] = 0.02;
    plant_->set_state(state);
    EXPECT_NEAR(forces_->spring_torque(x(), 0), -2.0 * k2 * c * 0.02, 1e-9);
    const double omega = std::sqrt(2.0 * k2 * c / kLink);
    double worst = 0.0;
    const double h = 1e-5;
    for (int k = 1; k <= 50000; ++k) {
      step(h);
      worst = std::max(worst, std::abs(x().q[0] - 0.02 * std::cos(omega * k * h)));
    }
    EXPECT_LT(worst, 0.02 * 2e-3) << c;
  }
}

// Equal torques wind up the preload alone: c'' = tau / B - f(c) / B from rest; energy says how far.
TEST_P(ElasticJoint, EqualTorquesWindUpThePreloadAlone) {
  const double k2 = 400.0;
  const double tau = 2.0;
  LoadedRobot robot = testing::one_joint(kLink, kRotor, 0.0);
  testing::make_antagonistic(&robot.robot.joints[0], k2, 0.0);
  make(robot);
  for (int motor : {0, 1}) set_torque(motor, tau);
  double most = 0.0;
  for (int k = 0; k < 4000; ++k) {
    step(kStep);
    most = std::max(most, x().theta[0]);
    ASSERT_NEAR(x().q[0], 0.0, 1e-12);
    ASSERT_NEAR(x().theta[0], x().theta[1], 1e-12);
  }
  EXPECT_NEAR(most, std::sqrt(6.0 * tau / k2), 1e-3 * most);  // tau c = k2 c^3 / 6
}

TEST_P(ElasticJoint, MotorsAtTheStartCarryTheWeight) {
  LoadedRobot robot = testing::planar_arm(testing::desktop());
  testing::make_elastic(&robot.robot.joints[0], 300.0, 0.5);
  testing::make_antagonistic(&robot.robot.joints[1], 400.0, 0.2);
  make(robot);
  VectorJ q(2);
  q << 0.3, -0.5;
  start_at(robot.robot, q, false, plant_.get());
  const VectorJ g = plant_->arm().gravity_torque();
  const auto s = testing::desktop();
  EXPECT_NEAR(g[1], s.m2 * s.l2 * 9.81 * std::cos(0.3 - 0.5), 1e-12);
  EXPECT_NEAR(x().theta[0], 0.3 + g[0] / 300.0, 1e-9);
  EXPECT_NEAR(0.5 * (x().theta[1] + x().theta[2]), 0.2, 1e-12);
  // sigma (e - q) = g with sigma = 2 k2 c
  EXPECT_NEAR(0.5 * (x().theta[1] - x().theta[2]), -0.5 + g[1] / 160.0, 1e-9);
  // Motors that give what their springs take stay, and so does the arm.
  for (int motor : {0, 1, 2}) {
    set_torque(motor, forces_->motor(motor).spring_torque(forces_->point(x(), motor)));
  }
  for (int k = 0; k < 40; ++k) step(kStep);
  EXPECT_LT((x().q - q).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_P(ElasticJoint, EnergyBookIsClosed) {
  for (const bool losses : {false, true}) {
    LoadedRobot robot = testing::planar_arm(testing::desktop());
    testing::make_elastic(&robot.robot.joints[0], 300.0, losses ? 0.2 : 0.0);
    testing::make_antagonistic(&robot.robot.joints[1], 400.0, 0.2);
    for (JointConfig& joint : robot.robot.joints) {
      joint.friction = {0.2, 0.3, 0.05, 0.02, 1e-3};
      joint.link_friction = {0.1, 0.1, 0.05, 0.01, 1e-3};
    }
    make(robot, losses);
    start_at(robot.robot, VectorJ::Zero(2), false, plant_.get());
    const double before = energy();
    double greatest = 0.0;
    double worst = 0.0;
    for (int k = 0; k < 8000; ++k) {
      const double t = k * kStep;
      set_torque(0, 3.0 * std::sin(5.0 * t));
      set_torque(1, 1.0 + 0.5 * std::sin(8.0 * t));
      set_torque(2, 1.0);
      step(kStep);
      const Work& work = plant_->work();
      const double held = energy() + forces_->bristle_energy() - before;
      worst = std::max(worst, std::abs(held - work.motor - work.friction - work.external));
      greatest = std::max({greatest, plant_->kinetic_energy(), std::abs(work.motor)});
    }
    EXPECT_GT(greatest, 1.0);
    EXPECT_LT(worst, (exact() ? 1e-3 : 5e-2) * greatest) << losses;
    if (losses) {
      EXPECT_LT(plant_->work().friction, -0.1);
    }
  }
}

/// A drive that holds its motor at zero, as good as still.
constexpr DriveLaw kHeld = {1e6, 2e3, 0.0, 0.0, 0.0, 1e9, 0.0};

// A push at the tip of the second rod, across it: the springs alone give way.
TEST_P(ElasticJoint, PushBendsTheSprings) {
  LoadedRobot robot = testing::planar_arm(testing::desktop());
  for (double& g : robot.robot.gravity) g = 0.0;
  testing::make_elastic(&robot.robot.joints[0], 400.0, 5.0);
  testing::make_elastic(&robot.robot.joints[1], 200.0, 2.0);
  for (JointConfig& joint : robot.robot.joints) joint.drive.rotor_inertia_kgm2 = 1.0;
  make(robot);
  Push push;
  push.link = plant_->arm().tip();
  push.wrench[1] = 2.0;
  push.duration_ns = 1'000'000;
  ASSERT_TRUE(forces_->environment.pushes.add(push, 0));
  for (int motor : {0, 1}) forces_->drives[motor] = kHeld;
  for (int k = 0; k < 8000; ++k) step(kStep);
  const VectorJ tau = plant_->external_torque(forces_->environment, 0);
  EXPECT_NEAR(tau[0], 2.0 * 0.65, 0.01);
  EXPECT_NEAR(x().q[0], tau[0] * (1.0 / 400.0 + 1e-6), 1e-6);
  EXPECT_NEAR(x().q[1], tau[1] * (1.0 / 200.0 + 1e-6), 1e-6);
}

// The stop, 700 N m/rad, carries the link's weight of 1 N m; the motor hangs on its spring.
TEST_P(ElasticJoint, EndStopHoldsTheLink) {
  LoadedRobot robot = testing::one_joint(kLink, kRotor, 1.0);
  testing::make_elastic(&robot.robot.joints[0], 100.0, 2.0);
  robot.robot.joints[0].position_min = -0.5;
  make(robot);
  VectorJ q(1);
  q << -0.45;
  plant_->set_state(q, VectorJ::Zero(1));
  for (int k = 0; k < 20000; ++k) step(kStep);
  const double weight = std::cos(x().q[0]);
  EXPECT_NEAR(x().q[0], -0.5 - weight / 700.0, 1e-5);
  EXPECT_NEAR(stretch(), 0.0, 1e-5);
}

// Hanging in the backlash's lower end: half its width, then the spring.
TEST_P(ElasticJoint, BacklashLetsTheLinkSag) {
  LoadedRobot robot = testing::one_joint(kLink, kRotor, 1.0);
  testing::make_elastic(&robot.robot.joints[0], 500.0, 10.0);
  robot.robot.joints[0].transmission.backlash_rad = 0.02;
  make(robot);
  forces_->drives[0] = kHeld;
  for (int k = 0; k < 20000; ++k) step(kStep);
  EXPECT_NEAR(x().q[0], -0.01 - std::cos(0.01) * (1.0 / 500.0 + 1e-6), 1e-6);
}

TEST_P(ElasticJoint, RattlingInTheBacklashMakesNoEnergy) {
  LoadedRobot robot = two_masses(5000.0, 0.0);
  robot.robot.joints[0].transmission.backlash_rad = 0.01;
  make(robot);
  ArmState state = x();
  state.theta_dot[0] = 1.0;
  plant_->set_state(state);
  const double start = energy();
  for (int k = 0; k < 8000; ++k) {
    step(kStep);
    ASSERT_LT(energy(), (exact() ? 1.01 : 1.1) * start) << k;
    ASSERT_GT(energy(), (exact() ? 0.99 : 0.9) * start) << k;
  }
}

TEST_P(ElasticJoint, MotorTorqueThatIsNoNumberStopsTheArmAndIsCounted) {
  make(two_masses(5000.0, 2.0));
  displace_motor(0.01);
  for (int k = 0; k < 40; ++k) step(kStep);
  const double theta = x().theta[0];
  set_torque(0, std::numeric_limits<double>::quiet_NaN());
  for (int k = 0; k < 40; ++k) step(kStep);
  EXPECT_EQ(plant_->diverged(), 40);
  EXPECT_EQ(x().theta[0], theta);
  EXPECT_EQ(x().theta_dot[0], 0.0);
}

TEST(Integrators, AMotorBehindASpringNeedsInertia) {
  LoadedRobot robot = testing::one_joint(kLink, 0.0, 0.0);
  EXPECT_NO_THROW(make_arm_plant(Integrator::kReference, build_arm_model(robot)));
  testing::make_elastic(&robot.robot.joints[0], 100.0, 1.0);
  EXPECT_THROW(make_arm_plant(Integrator::kReference, build_arm_model(robot)), ConfigError);
}

}  // namespace
}  // namespace limber::sim::test_elastic_joints
