// The link meets the stiffness asked for although only the motor's position is known.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "controller/elastic/qbar.h"
#include "tests/controller/arms.h"
#include "tools/allocations/allocations.h"

namespace limber::controller::test_qbar {
namespace {

constexpr double kWeight = 15.0;  // m g l, N m

// One joint that carries a rod from a vertical axis: g = kWeight sin(q), hanging at q = 0.
LoadedRobot pendulum() {
  KDL::Chain chain;
  chain.addSegment(KDL::Segment(
      KDL::Joint("j", KDL::Joint::RotZ), KDL::Frame(KDL::Vector(0, -1, 0)),
      KDL::RigidBodyInertia(kWeight / 9.81, KDL::Vector::Zero(), KDL::RotationalInertia::Zero())));
  return limber::testing::with_drives(chain, Eigen::Vector3d(0, -9.81, 0));
}

VectorJ one(double x) { return VectorJ::Constant(1, x); }
JointSpring spring_of(double K_d) { return {one(0.7), MatrixJ::Constant(1, 1, K_d)}; }

// u = l(q_bar) at the motor and K_J (theta - q) - g = -tau_ext at the link: the deflection of a
// link pushed by tau_ext, by bisection over theta.
double link_deflection(QbarSolver* solver, double K_J, double K_d, double tau_ext) {
  double low = -2.0;
  double high = 3.0;
  const auto link_at = [&](double theta) {
    solver->reset();
    EXPECT_TRUE(solver->solve(one(theta), spring_of(K_d)));
    // At rest the motor's torque is the spring's.
    return theta - solver->u()[0] / K_J;
  };
  for (int i = 0; i < 100; ++i) {
    const double theta = 0.5 * (low + high);
    const double q = link_at(theta);
    const double balance = K_J * (theta - q) - kWeight * std::sin(q) + tau_ext;
    (balance > 0.0 ? low : high) = theta;
  }
  return link_at(0.5 * (low + high)) - 0.7;
}

TEST(Qbar, LinkStiffnessIsExactlyTheOneAsked) {
  ArmModel model(pendulum());
  QbarSolver solver(&model, one(1000.0));
  for (const double K_d : {100.0, 500.0, 900.0}) {
    EXPECT_NEAR(link_deflection(&solver, 1000.0, K_d, 4.0), 4.0 / K_d, 1e-9) << K_d;
    EXPECT_NEAR(link_deflection(&solver, 1000.0, K_d, -2.0), -2.0 / K_d, 1e-9) << K_d;
  }
}

// With slope s = K_d - dg/dq constant enough, each fixpoint step shrinks the error by s / K_J.
TEST(Qbar, FixpointContractsByTheRatioOfStiffnesses) {
  ArmModel model(pendulum());
  const auto iterations = [&](double K_d) {
    QbarSolver solver(&model, one(1000.0), {.tolerance = 1e-12, .newton = false});
    EXPECT_TRUE(solver.solve(one(0.75), spring_of(K_d)));
    return solver.iterations();
  };
  const double slope = kWeight * std::cos(0.7);
  for (const double K_d : {100.0, 500.0}) {
    const double factor = (K_d - slope) / 1000.0;
    EXPECT_NEAR(iterations(K_d), std::log(1e-12 / 0.05) / std::log(factor), 3.0) << K_d;
  }
}

TEST(Qbar, RefusesALinkStifferThanItsSpring) {
  ArmModel model(pendulum());
  QbarSolver solver(&model, one(1000.0));
  EXPECT_FALSE(solver.solve(one(0.75), spring_of(1500.0)));
  EXPECT_EQ(solver.q_bar()[0], 0.75) << "falls back to the motor's position";
  EXPECT_NEAR(solver.u()[0], kWeight * std::sin(0.75) - 1500.0 * 0.05, 1e-9);
  QbarSolver fixpoint(&model, one(1000.0), {.newton = false});
  EXPECT_FALSE(fixpoint.solve(one(0.75), spring_of(1500.0)));
  EXPECT_FALSE(solver.solve(one(NAN), spring_of(100.0)));
  EXPECT_EQ(solver.q_bar()[0], 0.75);
  EXPECT_TRUE(solver.u().allFinite());
}

// A rod that stands on a spring of 14 N m/rad under 15 N m buckles: what Newton finds is another
// balance, far over. With 15.5 it stands, but would follow the motor thirty-fold.
TEST(Qbar, RefusesALinkThatBuckles) {
  ArmModel model(pendulum());
  const JointSpring none{one(0.0), MatrixJ::Zero(1, 1)};
  for (const double K_J : {14.0, 15.5}) {
    QbarSolver solver(&model, one(K_J));
    EXPECT_FALSE(solver.solve(one(3.12), none)) << K_J;
    EXPECT_EQ(solver.q_bar()[0], 3.12) << K_J;
  }
  QbarSolver solver(&model, one(20.0));
  EXPECT_TRUE(solver.solve(one(3.12), none));
  EXPECT_NEAR(20.0 * (3.12 - solver.q_bar()[0]), kWeight * std::sin(solver.q_bar()[0]), 1e-9);
}

TEST(Qbar, NewtonSolvesWhereTheFixpointCannot) {
  // A spring of 10 N m/rad under a weight of 15 N m that hangs: dg/dq / K_J = 1.5.
  ArmModel model(pendulum());
  const JointSpring none{one(0.0), MatrixJ::Zero(1, 1)};
  QbarSolver fixpoint(&model, one(10.0), {.newton = false});
  EXPECT_FALSE(fixpoint.solve(one(0.3), none));
  QbarSolver solver(&model, one(10.0));
  EXPECT_TRUE(solver.solve(one(0.3), none));
  const double q = solver.q_bar()[0];
  EXPECT_NEAR(10.0 * (0.3 - q), kWeight * std::sin(q), 1e-10);
}

class QbarArm : public ::testing::Test {
 protected:
  QbarArm() : model(limber::testing::seven_joint_arm()), K_J(7), terms(7) {
    K_J << 8e3, 8e3, 6e3, 6e3, 3e3, 3e3, 2e3;
    q_0 = VectorJ::Constant(7, 0.4) + random_vector(7, 0.2);
    model.evaluate(q_0, VectorJ::Zero(7), &terms);
    spring.X_BD = terms.X_BT;
    spring.K_x.setZero();
    spring.K_x.diagonal() << 3000, 3000, 3000, 150, 150, 150;
  }
  VectorJ random_vector(int n, double size) {
    return limber::testing::random_vector(n, size, generator);
  }

  std::mt19937 generator{4};
  ArmModel model;
  VectorJ K_J;
  ArmTerms terms;
  VectorJ q_0;
  TipSpring spring;
};

TEST_F(QbarArm, SolvesItsEquationColdAndWarm) {
  QbarSolver solver(&model, K_J);
  VectorJ theta = q_0 + random_vector(7, 0.03);
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(solver.solve(theta, spring));
    const VectorJ residual = K_J.cwiseProduct(theta - solver.q_bar()) - solver.u();
    EXPECT_LT(residual.cwiseAbs().maxCoeff(), 1e-8);
    ArmTerms at(7);
    model.evaluate(solver.q_bar(), VectorJ::Zero(7), &at);
    const PoseError error = pose_error(at.X_BT, spring.X_BD, spring.orientation);
    const VectorJ l = at.g - at.J.transpose() * (error.A.transpose() * (spring.K_x * error.e));
    EXPECT_LT((l - solver.u()).norm(), 1e-9);
    EXPECT_EQ(solver.terms().J, at.J);
    theta += random_vector(7, 1e-5);
  }
}

// A link that the load F has pushed F / 3000 away from the goal is at rest if motor and springs
// carry g - J^T F. Seen from the motor's position, that is the equilibrium the solver has to find:
// tip compliance K_x^-1, without the J K_J^-1 J^T of the springs.
TEST_F(QbarArm, TipComplianceIsExactlyTheInverseStiffness) {
  QbarSolver solver(&model, K_J);
  for (int i = 0; i < 10; ++i) {
    Vector6 F = Vector6::Zero();
    F.head<3>() = random_vector(3, 27.0);
    spring.X_BD.p = terms.X_BT.p - F.head<3>() / 3000.0;
    const VectorJ carried = terms.g - terms.J.transpose() * F;
    const VectorJ theta = q_0 + carried.cwiseQuotient(K_J);
    ASSERT_TRUE(solver.solve(theta, spring));
    EXPECT_LT((solver.q_bar() - q_0).norm(), 1e-10);
    EXPECT_LT((solver.u() - carried).norm(), 1e-7);
    EXPECT_GT((theta - q_0).norm(), 1e-4) << "the springs do give way";
  }
}

TEST_F(QbarArm, DoesNotAllocate) {
  QbarSolver solver(&model, K_J);
  QbarSolver soft(&model, 0.01 * K_J);  // takes the Newton branch
  const JointSpring none{q_0, MatrixJ::Zero(7, 7)};
  const auto before = limber::allocations();
  solver.solve(q_0, spring);
  soft.solve(q_0, spring);
  soft.solve(q_0, none);
  EXPECT_EQ(limber::allocations(), before);
}

}  // namespace
}  // namespace limber::controller::test_qbar
