// Laws at the motor of an elastic joint, against what they do to the joint's equations.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "controller/elastic/full_state_feedback.h"
#include "controller/elastic/tomei.h"
#include "lecture/eval/deflection_pd.h"
#include "lecture/eval/elastic_arm.h"
#include "lecture/eval/torque_feedback.h"
#include "tests/controller/arms.h"
#include "tools/allocations/allocations.h"

namespace limber::controller::test_motor_laws {
namespace {

using namespace limber::eval;  // models that the controller does not run

using limber::testing::random_vector;

MatrixJ diagonal(const VectorJ& x) { return x.asDiagonal(); }
VectorJ one(double x) { return VectorJ::Constant(1, x); }
MatrixJ square(double x) { return MatrixJ::Constant(1, 1, x); }
VectorJ positive_vector(int n, std::mt19937& generator) {
  return VectorJ::Constant(n, 2.0) + random_vector(n, 1.0, generator);
}

class MotorLaws : public ::testing::Test {
 protected:
  MotorLaws() : generator(6), model(limber::testing::seven_joint_arm()), terms(7) {
    q = random_vector(7, 0.8, generator);
    v = random_vector(7, 1.0, generator);
    theta = q + random_vector(7, 0.02, generator);
    theta_dot = v + random_vector(7, 0.1, generator);
    joints = {1000.0 * positive_vector(7, generator), 3.0 * positive_vector(7, generator),
              0.2 * positive_vector(7, generator)};
    tau_m = random_vector(7, 10.0, generator);
    tau_f = random_vector(7, 1.0, generator);
    F_ext = limber::testing::random_six(10.0, generator);
    model.evaluate(q, v, &terms);
  }
  ElasticArmRate rate(const VectorJ& motor) {
    return elastic_arm_rate(terms, joints, q, v, theta, theta_dot, motor, tau_f, F_ext);
  }

  std::mt19937 generator;
  ArmModel model;
  ArmTerms terms;
  ElasticJoints joints;
  VectorJ q, v, theta, theta_dot, tau_m, tau_f;
  Vector6 F_ext;
};

// Momentum of links and rotors together changes by what comes from outside alone: the springs'
// torques cancel.
TEST_F(MotorLaws, SpringsActOnBothSides) {
  const ElasticArmRate r = rate(tau_m);
  const VectorJ links = terms.M * r.qdd + terms.Cv + terms.g;
  const VectorJ rotors = joints.B.cwiseProduct(r.theta_dd);
  const VectorJ outside = tau_m - tau_f + terms.J.transpose() * F_ext;
  EXPECT_LT((links + rotors - outside).norm(), 1e-10 * links.norm());
  for (int i = 0; i < 7; ++i) {
    EXPECT_NEAR(r.tau[i], joints.K_J[i] * (theta[i] - q[i]), 1e-12);
    EXPECT_NEAR(r.tau_t[i] - r.tau[i], joints.D_J[i] * (theta_dot[i] - v[i]), 1e-12);
  }
}

TEST_F(MotorLaws, EnergyFallsByWhatTheJointDampersTake) {
  // d/dt (kinetic + springs) = v.(tau_t - g + J^T F) + theta'.(tau_m - tau_f - tau_t) + tau.(...)
  const ElasticArmRate r = rate(tau_m);
  const VectorJ beta = terms.M * r.qdd + terms.Cv;  // v.(dM/dt) v / 2 = v.C v
  const double kinetic = v.dot(beta) + theta_dot.dot(joints.B.cwiseProduct(r.theta_dd));
  const double springs = r.tau.dot(theta_dot - v);
  const double supplied =
      theta_dot.dot(tau_m - tau_f) + v.dot(terms.J.transpose() * F_ext) - v.dot(terms.g);
  const VectorJ slip = theta_dot - v;
  const double lost = slip.dot(joints.D_J.cwiseProduct(slip));
  EXPECT_NEAR(kinetic + springs, supplied - lost, 1e-9 * std::abs(supplied));
  EXPECT_GT(lost, 0.01);
}

TEST_F(MotorLaws, TorqueFeedbackMakesTheMotorAnotherOne) {
  const VectorJ B_theta = 0.25 * joints.B;
  const TorqueFeedback law{joints.B, B_theta, joints.K_J, joints.D_J};
  const VectorJ u = random_vector(7, 5.0, generator);
  const VectorJ tau = joints.K_J.cwiseProduct(theta - q);
  const VectorJ tau_dot = joints.K_J.cwiseProduct(theta_dot - v);
  const ElasticArmRate r = rate(law.torque(u, tau, tau_dot));
  const VectorJ seen = B_theta.cwiseProduct(r.theta_dd) + r.tau_t + 0.25 * tau_f;
  EXPECT_LT((seen - u).norm(), 1e-10 * r.tau_t.norm());
}

TEST_F(MotorLaws, FullStateIsTorqueFeedbackInOtherGains) {
  constexpr double rho = 4.0;
  const TorqueFeedback inner{joints.B, joints.B / rho, joints.K_J, joints.D_J};
  const VectorJ K_P = positive_vector(7, generator) * 100.0;
  const VectorJ K_D = positive_vector(7, generator) * 10.0;
  const VectorJ g_ff = random_vector(7, 10.0, generator);
  const VectorJ error = theta - q;
  const VectorJ tau = joints.K_J.cwiseProduct(theta - q);
  const VectorJ tau_dot = joints.K_J.cwiseProduct(theta_dot - v);
  const VectorJ u = g_ff - K_P.cwiseProduct(error) - K_D.cwiseProduct(theta_dot);
  const FullStateFeedback full{diagonal(rho * K_P), diagonal(rho * K_D),
                               (rho - 1.0) * MatrixJ::Identity(7, 7),
                               diagonal((rho - 1.0) * joints.D_J), joints.K_J};
  const VectorJ difference =
      full.torque(error, theta_dot, tau, tau_dot, g_ff) - inner.torque(u, tau, tau_dot);
  EXPECT_LT(difference.norm(), 1e-9);
}

TEST(DeflectionPd, PresentsItsInertiaAndNoStiffness) {
  // One joint, 1 N m on the link, after the transient: both ends accelerate alike with
  // M + B / (1 + K_pm / K_J).
  constexpr double M = 0.5;
  constexpr double B = 0.2;
  constexpr double K_J = 5000.0;
  constexpr double K_pm = 15000.0;
  Eigen::Matrix2d
      A;  // M q'' = K_J s + 1, B theta'' = -K_J s - K_pm s, s = theta - q, q'' = theta''
  A << M, -K_J, B, K_J + K_pm;
  const Eigen::Vector2d x = A.lu().solve(Eigen::Vector2d(1.0, 0.0));
  EXPECT_NEAR(x[0], 1.0 / (M + B / (1.0 + K_pm / K_J)), 1e-12);
  const double tau_m = deflection_torque(square(K_pm), square(7.0), one(0.3), one(2.0),
                                         one(0.3 + x[1]), one(2.0))[0];
  EXPECT_NEAR(tau_m, B * x[0] + K_J * x[1], 1e-12);
  EXPECT_NEAR(
      deflection_torque(square(0.0), square(7.0), one(0.0), one(2.0), one(0.0), one(3.0))[0], -7.0,
      1e-15);
}

TEST(Tomei, HoldsTheLinkAtItsGoal) {
  std::mt19937 generator(7);
  ArmModel model(limber::testing::seven_joint_arm());
  const VectorJ q_d = random_vector(7, 0.7, generator);
  const VectorJ g_d = model.gravity(q_d);
  const Tomei law{300.0 * MatrixJ::Identity(7, 7), 20.0 * MatrixJ::Identity(7, 7),
                  VectorJ::Constant(7, 800.0)};
  const VectorJ theta_d = law.theta_d(q_d, g_d);
  // At theta_d the spring carries the link at q_d, and the motor the spring.
  EXPECT_LT((law.K_J.cwiseProduct(theta_d - q_d) - g_d).norm(), 1e-10);
  EXPECT_LT((law.torque(theta_d, VectorJ::Zero(7), q_d, g_d) - g_d).norm(), 1e-12);
  const VectorJ off =
      law.torque(theta_d + VectorJ::Unit(7, 2) * 0.1, VectorJ::Unit(7, 4), q_d, g_d);
  EXPECT_LT((off - g_d + 30.0 * VectorJ::Unit(7, 2) + 20.0 * VectorJ::Unit(7, 4)).norm(), 1e-12);
}

// One joint: lambda_min(K_P) = alpha has the closed form K_P = K_J^2 / (K_J - alpha) - K_J + alpha.
TEST(Tomei, LambdaMinAgainstTheClosedFormOfOneJoint) {
  for (const double alpha : {1.0, 20.0, 50.0}) {
    constexpr double K_J = 60.0;
    const double K_P = K_J * K_J / (K_J - alpha) - K_J + alpha;
    EXPECT_NEAR((Tomei{square(K_P), square(0.0), one(K_J)}.lambda_min()), alpha, 1e-10);
  }
  EXPECT_NEAR(critical_motor_gain(60.0, 20.0), 30.0, 1e-12);
  EXPECT_TRUE(std::isinf(critical_motor_gain(20.0, 20.0)));
  // Joints that do not share gains do not share the smallest eigenvalue either.
  const VectorJ K_J = (VectorJ(2) << 60.0, 600.0).finished();
  const VectorJ K_P = (VectorJ(2) << 50.0, 5000.0).finished();
  EXPECT_NEAR((Tomei{diagonal(K_P), diagonal(K_P), K_J}.lambda_min()), 20.0, 1e-9);
}

TEST(GravityGradient, OfTheTextbookArm) {
  const limber::testing::PlanarParameters p = limber::testing::kDesktop;
  ArmModel model(limber::testing::planar_arm(p));
  const VectorJ q = (VectorJ(2) << 0.4, 0.9).finished();
  const MatrixJ G = model.gravity_gradient(q);
  const double second = -9.81 * p.m2 * p.l2 * std::sin(q[0] + q[1]);
  const double first =
      -9.81 * (p.m1 * p.l1 + (p.motor_mass + p.m2) * p.a1) * std::sin(q[0]) + second;
  EXPECT_NEAR(G(0, 0), first, 1e-13);
  EXPECT_NEAR(G(0, 1), second, 1e-13);
  EXPECT_NEAR(G(1, 1), second, 1e-13);
}

TEST_F(MotorLaws, NothingAllocates) {
  const MatrixJ K = MatrixJ::Identity(7, 7);
  const TorqueFeedback feedback{joints.B, joints.B, joints.K_J, joints.D_J};
  const FullStateFeedback full{K, K, K, K, joints.K_J};
  const Tomei tomei{K, K, joints.K_J};
  const auto before = limber::allocations();
  const double sum = rate(tau_m).qdd[0] + feedback.torque(q, v, v)[0] +
                     full.torque(q, v, q, v, q)[0] + tomei.torque(q, v, q, q)[0] +
                     deflection_torque(K, K, q, v, q, v)[0] + model.gravity_gradient(q)(0, 0);
  EXPECT_EQ(limber::allocations(), before);
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace limber::controller::test_motor_laws
