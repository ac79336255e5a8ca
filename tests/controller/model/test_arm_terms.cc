// Kinematics and dynamics against closed forms and against their own definitions.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "common/config_error.h"
#include "controller/model/rotation.h"
#include "tests/controller/arms.h"
#include "tools/allocations/allocations.h"

namespace limber::controller::test_arm_terms {
namespace {

using limber::testing::kDesktop;
using limber::testing::kTextbook;
using limber::testing::PlanarParameters;

VectorJ pair(double a, double b) {
  VectorJ result(2);
  result << a, b;
  return result;
}

ArmTerms terms_at(const LoadedRobot& robot, const VectorJ& q, const VectorJ& v) {
  ArmModel model(robot);
  ArmTerms terms(model.size());
  model.evaluate(q, v, &terms);
  return terms;
}

// All arms that the finite-difference checks run on.
std::vector<LoadedRobot> many_arms() {
  std::vector<LoadedRobot> arms{limber::testing::planar_arm(kDesktop),
                                limber::testing::seven_joint_arm()};
  for (const int n : {1, 2, 4, 6, 9, 16}) {
    arms.push_back(limber::testing::random_arm(n, static_cast<unsigned>(n), false));
    arms.push_back(limber::testing::random_arm(n, static_cast<unsigned>(100 + n), true));
  }
  return arms;
}

// Computed once with the closed form and checked against an independent dynamics library; the mass
// matrix there holds the rotor terms of Siciliano et al. 2009, section 7.3.2.
struct Golden {
  const PlanarParameters* arm;
  double q[2], v[2], a[2], tip[2], M[3], Cv[2], g[2], tau[2];
};
const Golden kGolden[] = {
    {&kTextbook,
     {0.0, 0.0},
     {0.0, 0.0},
     {0.0, 0.0},
     {2.0, 0.0},
     {250.01, 48.5, 122.5},
     {0.0, 0.0},
     {1030.05, 245.25},
     {1030.05, 245.25}},
    {&kTextbook,
     {1.378, -1.374},
     {-0.799, 1.494},
     {0.0, 0.0},
     {1.1915961578, 0.9854722746},
     {209.7864251804, 28.3882125902, 122.5},
     {-3.8094233846, -15.6519648991},
     {395.6189810189, 245.2480380026},
     {391.8095576342, 229.5960731035}},
    {&kTextbook,
     {-2.474, 1.606},
     {1.188, -0.128},
     {-1.97, -2.216},
     {-0.1389604071, -1.3821350153},
     {198.2501798827, 22.6200899414, 122.5},
     {7.1891429511, 35.2617387997},
     {-457.7963820569, 158.518297517},
     {-891.2862127849, -122.2415408678}},
    {&kDesktop,
     {-0.016, -1.262},
     {-1.953, -1.23},
     {1.92, -2.994},
     {0.4365444009, -0.2928319153},
     {0.2350966179, 0.0369443089, 0.0258},
     {0.2527758703, -0.1526194817},
     {6.1759789071, 0.3397760208},
     {6.7695290228, 0.1808444122}},
    {&kDesktop,
     {0.049, 1.736},
     {0.559, 0.967},
     {-4.085, 0.411},
     {0.2858090986, 0.3102869316},
     {0.1957539283, 0.0172729641, 0.0258},
     {-0.0835272591, 0.0129455144},
     {5.5797074831, -0.2502366603},
     {4.7036246152, -0.2972474044}},
};

TEST(ArmTerms, PlanarArmGoldenNumbers) {
  for (const Golden& golden : kGolden) {
    const PlanarParameters& p = *golden.arm;
    const ArmTerms terms = terms_at(limber::testing::planar_arm(p), pair(golden.q[0], golden.q[1]),
                                    pair(golden.v[0], golden.v[1]));
    const double tolerance = 2e-9 * golden.M[0] / 0.2;
    EXPECT_NEAR(terms.X_BT.p.x(), golden.tip[0], 1e-9);
    EXPECT_NEAR(terms.X_BT.p.y(), golden.tip[1], 1e-9);
    // The coupling of a rotor that turns while it is carried along is left out of M + B (a rotor
    // here has no energy but B theta_dot^2 / 2): Im2 in M11 and kr2 Im2 in M12.
    EXPECT_NEAR(terms.M_total(0, 0), golden.M[0] - p.Im2, tolerance);
    EXPECT_NEAR(terms.M_total(0, 1), golden.M[1] - p.kr2 * p.Im2, tolerance);
    EXPECT_NEAR(terms.M_total(1, 1), golden.M[2], tolerance);
    EXPECT_NEAR(terms.B[0], p.kr1 * p.kr1 * p.Im1, 1e-12);
    EXPECT_NEAR((terms.M_total - terms.M)(1, 1), p.kr2 * p.kr2 * p.Im2, 1e-12);
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(terms.Cv[i], golden.Cv[i], tolerance);
      EXPECT_NEAR(terms.g[i], golden.g[i], tolerance);
    }
    MatrixJ M = terms.M_total;
    M(0, 0) += p.Im2;
    M(0, 1) += p.kr2 * p.Im2;
    M(1, 0) += p.kr2 * p.Im2;
    const VectorJ tau = M * pair(golden.a[0], golden.a[1]) + terms.Cv + terms.g;
    EXPECT_NEAR(tau[0], golden.tau[0], 10 * tolerance);
    EXPECT_NEAR(tau[1], golden.tau[1], 10 * tolerance);
  }
}

TEST(ArmTerms, PlanarArmClosedFormEverywhere) {
  std::mt19937 generator(1);
  const PlanarParameters& p = kDesktop;
  const LoadedRobot robot = limber::testing::planar_arm(p);
  for (int i = 0; i < 50; ++i) {
    const VectorJ q = limber::testing::random_vector(2, 3.0, generator);
    const VectorJ v = limber::testing::random_vector(2, 3.0, generator);
    const ArmTerms terms = terms_at(robot, q, v);
    const double c1 = std::cos(q[0]), s1 = std::sin(q[0]);
    const double c12 = std::cos(q[0] + q[1]), s12 = std::sin(q[0] + q[1]);
    Matrix6J J = Matrix6J::Zero(6, 2);
    J.row(0) << -p.a1 * s1 - p.a2 * s12, -p.a2 * s12;
    J.row(1) << p.a1 * c1 + p.a2 * c12, p.a2 * c12;
    J.row(5) << 1.0, 1.0;
    EXPECT_LT((terms.J - J).norm(), 1e-13);
    const double w = v[0] + v[1];
    Vector6 Jdot_v = Vector6::Zero();
    Jdot_v[0] = -p.a1 * c1 * v[0] * v[0] - p.a2 * c12 * w * w;
    Jdot_v[1] = -p.a1 * s1 * v[0] * v[0] - p.a2 * s12 * w * w;
    EXPECT_LT((terms.Jdot_v - Jdot_v).norm(), 1e-12);
    const double h = -p.m2 * p.a1 * p.l2 * std::sin(q[1]);
    EXPECT_NEAR(terms.Cv[0], h * v[1] * v[0] + h * w * v[1], 1e-12);
    EXPECT_NEAR(terms.Cv[1], -h * v[0] * v[0], 1e-12);
    EXPECT_NEAR(terms.X_BT.Q.angularDistance(
                    Eigen::Quaterniond(Eigen::AngleAxisd(q[0] + q[1], Eigen::Vector3d::UnitZ()))),
                0.0, 1e-7);
  }
}

TEST(ArmTerms, JacobianIsTheDerivativeOfThePose) {
  std::mt19937 generator(2);
  constexpr double h = 1e-6;
  for (const LoadedRobot& robot : many_arms()) {
    const int n = robot.robot.size();
    const VectorJ q = limber::testing::random_vector(n, 1.0, generator);
    const VectorJ v = limber::testing::random_vector(n, 1.0, generator);
    ArmModel model(robot);
    const ArmTerms at = terms_at(robot, q, v);
    for (int i = 0; i < n; ++i) {
      const Pose plus = model.tip_pose(q + h * VectorJ::Unit(n, i));
      const Pose minus = model.tip_pose(q - h * VectorJ::Unit(n, i));
      Vector6 column;
      column << (plus.p - minus.p) / (2 * h), log_rotation(plus.Q * minus.Q.conjugate()) / (2 * h);
      EXPECT_LT((at.J.col(i) - column).norm(), 1e-8) << n << " joints, column " << i;
    }
    EXPECT_LT((at.V_BT - at.J * v).norm(), 1e-14);
    const Vector6 Jdot_v =
        (terms_at(robot, q + h * v, v).J - terms_at(robot, q - h * v, v).J) * v / (2 * h);
    EXPECT_LT((at.Jdot_v - Jdot_v).norm(), 1e-7 * (1.0 + Jdot_v.norm())) << n << " joints";
  }
}

TEST(ArmTerms, MassMatrixIsSymmetricPositiveDefiniteAndGivesTheTipItsInertia) {
  std::mt19937 generator(3);
  for (const LoadedRobot& robot : many_arms()) {
    const int n = robot.robot.size();
    const ArmTerms terms =
        terms_at(robot, limber::testing::random_vector(n, 2.0, generator), VectorJ::Zero(n));
    EXPECT_LT((terms.M - terms.M.transpose()).norm(), 1e-13 * terms.M.norm());
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<MatrixJ>(terms.M).eigenvalues().minCoeff(), 0.0);
    EXPECT_LT((terms.M_total * terms.Minv_JT - terms.J.transpose()).norm(), 1e-11);
    EXPECT_EQ(terms.Cv.norm(), 0.0) << "no Coriolis torque at rest";
  }
}

// Mdot - 2 C is skew: v^T Mdot v / 2 = v^T C v. And C v is what the Lagrangian says:
// C v = Mdot v - (1/2) d(v^T M v)/dq.
TEST(ArmTerms, CoriolisFollowsFromTheMassMatrix) {
  std::mt19937 generator(4);
  constexpr double h = 1e-5;
  for (const LoadedRobot& robot : many_arms()) {
    const int n = robot.robot.size();
    const VectorJ q = limber::testing::random_vector(n, 1.0, generator);
    const VectorJ v = limber::testing::random_vector(n, 1.0, generator);
    const ArmTerms at = terms_at(robot, q, v);
    const MatrixJ Mdot =
        (terms_at(robot, q + h * v, v).M - terms_at(robot, q - h * v, v).M) / (2 * h);
    EXPECT_NEAR(v.dot(Mdot * v), 2.0 * v.dot(at.Cv), 1e-7 * (1.0 + Mdot.norm()));
    VectorJ gradient(n);
    for (int i = 0; i < n; ++i) {
      const VectorJ step = h * VectorJ::Unit(n, i);
      gradient[i] =
          (v.dot(terms_at(robot, q + step, v).M * v) - v.dot(terms_at(robot, q - step, v).M * v)) /
          (2 * h);
    }
    EXPECT_LT((at.Cv - (Mdot * v - 0.5 * gradient)).norm(), 1e-7 * (1.0 + Mdot.norm()));
  }
}

// The work of g along any path is the weight's potential: its curl vanishes.
TEST(ArmTerms, GravityTorqueHasAPotential) {
  std::mt19937 generator(5);
  constexpr double h = 1e-6;
  for (const LoadedRobot& robot : many_arms()) {
    const int n = robot.robot.size();
    const VectorJ q = limber::testing::random_vector(n, 1.0, generator);
    const VectorJ rest = VectorJ::Zero(n);
    MatrixJ derivative(n, n);
    for (int i = 0; i < n; ++i) {
      const VectorJ step = h * VectorJ::Unit(n, i);
      derivative.col(i) =
          (terms_at(robot, q + step, rest).g - terms_at(robot, q - step, rest).g) / (2 * h);
    }
    EXPECT_LT((derivative - derivative.transpose()).norm(), 1e-6 * (1.0 + derivative.norm()));
  }
}

// A free arm keeps its energy. Its potential is integrated along with the motion from g alone.
TEST(ArmTerms, FreeMotionKeepsItsEnergy) {
  for (const LoadedRobot& robot :
       {limber::testing::planar_arm(kDesktop), limber::testing::seven_joint_arm(),
        limber::testing::random_arm(5, 7, true)}) {
    limber::testing::Plant plant(robot);
    const int n = robot.robot.size();
    std::mt19937 generator(6);
    plant.q = limber::testing::random_vector(n, 0.5, generator);
    plant.v = limber::testing::random_vector(n, 0.5, generator);
    const VectorJ none = VectorJ::Zero(n);
    double lost = 0.0;  // integral of g v, Simpson's rule over two steps
    const double start = plant.kinetic_energy();
    double most = start;
    const auto power = [&] { return plant.kinetic_energy(), plant.terms.g.dot(plant.v); };
    for (int i = 0; i < 500; ++i) {
      constexpr double dt = 5e-4;
      const double before = power();
      plant.advance(dt, [&](const VectorJ&, const VectorJ&) { return none; });
      const double middle = power();
      plant.advance(dt, [&](const VectorJ&, const VectorJ&) { return none; });
      lost += dt / 3.0 * (before + 4.0 * middle + power());
      most = std::max(most, plant.kinetic_energy());
      ASSERT_NEAR(plant.kinetic_energy() + lost, start, 1e-7 * most) << "step " << i;
    }
    EXPECT_GT(most, 2.0 * start) << "the test must move the arm";
  }
}

TEST(ArmTerms, WrongChainsAreRefused) {
  const double gravity[3] = {0, 0, -9.81};
  EXPECT_THROW(ArmModel(KDL::Chain(), gravity, {}), ConfigError);
  const LoadedRobot robot = limber::testing::seven_joint_arm();
  EXPECT_THROW(ArmModel(robot.chain, gravity, {0.1, 0.1}), ConfigError);
  KDL::Chain long_chain;
  for (int i = 0; i < 3; ++i) long_chain.addChain(robot.chain);
  EXPECT_THROW(ArmModel(long_chain, gravity, std::vector<double>(21, 0.0)), ConfigError);
}

TEST(ArmTerms, EvaluationDoesNotAllocate) {
  for (const LoadedRobot& robot : many_arms()) {
    const int n = robot.robot.size();
    ArmModel model(robot);
    ArmTerms terms(n);
    const VectorJ q = VectorJ::Constant(n, 0.3);
    const auto before = limber::allocations();
    model.evaluate(q, q, &terms);
    model.tip_pose(q);
    EXPECT_EQ(limber::allocations(), before) << n << " joints";
  }
}

}  // namespace
}  // namespace limber::controller::test_arm_terms
