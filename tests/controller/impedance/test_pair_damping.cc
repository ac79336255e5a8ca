// Two motors a joint are one rotor of both behind one spring, that of the preload: what the design
// says of their damping and of what is stable, against the sampled system.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

#include "controller/impedance/elastic_design.h"
#include "controller/impedance/stability.h"
#include "tests/controller/one_joint.h"
#include "tests/controller/rig.h"

namespace limber::controller::test_pair_damping {
namespace {

constexpr double kT = 1e-3;
constexpr double kLink = 0.5;    // kg m^2
constexpr double kRotors = 0.2;  // both
constexpr double kDamper = 2.0;  // N m s/rad
constexpr double k2 = 400.0;     // N m/rad^2

LoadedRobot pair_of(double preload, double K_q) {
  LoadedRobot robot =
      limber::testing::one_pair({.D_J = kDamper, .weight = 1e-3, .M = kLink, .B = kRotors});
  robot.robot.joints[0].transmission.preload_rad = preload;
  robot.robot.gains.K_q = {K_q};
  return robot;
}

// Spectral radius of link and rotors, their springs pulling with 2 k2 c, under -k theta - D theta',
// sampled every kT, a cycle late and held.
double spectral_radius(double preload, double k, double D) {
  const double K_J = 2.0 * k2 * preload;
  Eigen::Matrix<double, 5, 5> A = Eigen::Matrix<double, 5, 5>::Zero();  // q, q', theta, theta', tau
  A.row(0)[1] = A.row(2)[3] = 1.0;
  A.row(1) << -K_J / kLink, -kDamper / kLink, K_J / kLink, kDamper / kLink, 0.0;
  A.row(3) << K_J / kRotors, kDamper / kRotors, -K_J / kRotors, -kDamper / kRotors, 1.0 / kRotors;
  Eigen::Matrix<double, 5, 5> cycle = (A * kT).exp();
  cycle.row(4) << 0.0, 0.0, -k, -D, 0.0;
  return cycle.eigenvalues().cwiseAbs().maxCoeff();
}

// Softer than a share of 1 the sampled system is stable with the damper of the design, stiffer it
// is not.
TEST(PairDamping, ShareTellsWhetherTheSampledSystemIsStable) {
  for (const double preload : {0.15, 0.3, 0.6}) {
    const LoadedRobot robot = pair_of(preload, 50.0);
    ArmModel model(robot);
    ArmTerms terms(1);
    model.evaluate(VectorJ::Zero(1), VectorJ::Zero(1), &terms);
    const JointElasticity elastic(robot.robot, JointSprings(robot.robot));
    EXPECT_NEAR(elastic.K_J[0], 2.0 * k2 * preload, 1e-9);
    Gains gains(1, {});
    gains.joint_damping_ratio = 0.7;
    int stable = 0;
    int unstable = 0;
    for (double K = 1e3; K < 3e5; K *= 1.01) {
      gains.K_q(0, 0) = K;
      const double share = joint_modes(gains, terms, kT, &elastic).highest_share();
      const double D = elastic_joint_damping(elastic, terms, gains.K_q, 0.7)(0, 0);
      if (std::abs(share - 1.0) < 0.03) continue;
      ++(share < 1.0 ? stable : unstable);
      EXPECT_EQ(share < 1.0, spectral_radius(preload, K, D) < 1.0) << preload << ' ' << K;
    }
    EXPECT_GT(stable, 100);
    EXPECT_GT(unstable, 100);
  }
}

// Pushed and let go, the link swings through as the damping ratio says, whatever the preload.
TEST(PairDamping, LinkOvershootsAsAsked) {
  for (const double preload : {0.2, 0.4}) {
    limber::testing::Rig rig(pair_of(preload, 0.3 * 2.0 * k2 * preload), "joint_pd");
    rig.plant.q[0] = 0.0;
    rig.elastic->rest_at(rig.plant.q);
    rig.to_active();
    compliance_gains_t gains = rig.gains();
    gains.joint_damping_ratio = 0.3;
    ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
    rig.run(2.0);
    rig.plant.F_ext[0] = 4.0;
    rig.run(4.0);
    rig.plant.F_ext.setZero();
    const double held = rig.plant.q[0];
    double least = held;
    for (int i = 0; i < 1500; ++i) {
      rig.step();
      least = std::min(least, rig.plant.q[0]);
    }
    EXPECT_NEAR(-least / held, std::exp(-M_PI * 0.3 / std::sqrt(1.0 - 0.09)), 0.03) << preload;
  }
}

}  // namespace
}  // namespace limber::controller::test_pair_damping
