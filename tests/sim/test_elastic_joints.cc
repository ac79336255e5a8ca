// Joints with springs against the closed forms of two masses, and both integrators at steps longer
// than anybody should take.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "common/config_error.h"
#include "sim/arm_plant.h"
#include "sim/start_state.h"
#include "tests/sim/test_arms.h"

namespace limber::sim {
namespace {

constexpr double kStep = 250e-6;
constexpr double kLink = 0.5;
constexpr double kRotor = 0.2;
constexpr double kReduced = kLink * kRotor / (kLink + kRotor);

class BothIntegrators : public ::testing::TestWithParam<Integrator> {
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
INSTANTIATE_TEST_SUITE_P(Each, BothIntegrators,
                         ::testing::Values(Integrator::kOde, Integrator::kReference));

LoadedRobot two_masses(double stiffness, double damping) {
  LoadedRobot robot = testing::one_joint(kLink, kRotor, 0.0);
  testing::make_elastic(&robot.robot.joints[0], stiffness, damping);
  return robot;
}

// d'' + D/mu d' + K/mu d = 0, mu = M B / (M + B), while (M q + B theta) / (M + B) stays.
TEST_P(BothIntegrators, FreeVibrationIsThatOfTwoMasses) {
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
TEST_P(BothIntegrators, TorqueStepOfTheMotorShakesTheLink) {
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
TEST_P(BothIntegrators, AStiffSpringIsARigidJoint) {
  LoadedRobot robot = testing::one_joint(kLink, kRotor, 9.81);
  make(robot);
  for (int k = 0; k < 400; ++k) step(kStep);
  const double rigid = plant_->q()[0];
  testing::make_elastic(&robot.robot.joints[0], 1e7, 10.0);
  make(robot);
  for (int k = 0; k < 400; ++k) step(kStep);
  EXPECT_NEAR(plant_->q()[0], rigid, 2e-5);
}

}  // namespace
}  // namespace limber::sim
