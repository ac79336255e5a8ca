// The exact arm under each law accelerates as the law's equation says.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "controller/impedance/stiffness_mapping.h"
#include "controller/model/pose_error.h"
#include "tests/controller/law_bench.h"

namespace limber::controller::test_closed_loop {
namespace {

using limber::testing::LawBench;
using limber::testing::Plant;
using limber::testing::random_arm;
using limber::testing::random_six;
using limber::testing::random_stiffness;
using limber::testing::random_vector;

// Positive definite, eigenvalues about `size`, full.
MatrixJ random_positive(int n, double size, std::mt19937& generator) {
  MatrixJ A(n, n);
  for (int i = 0; i < n; ++i) A.col(i) = random_vector(n, 1.0, generator);
  return size * (A * A.transpose() / double(n) + MatrixJ::Identity(n, n));
}

// C(q, v) from the Christoffel symbols of M, by central differences.
MatrixJ coriolis_matrix(ArmModel* model, const VectorJ& q, const VectorJ& v) {
  const auto n = q.size();
  constexpr double h = 1e-5;
  std::vector<MatrixJ> dM;
  for (Eigen::Index k = 0; k < n; ++k) {
    const VectorJ step = h * VectorJ::Unit(n, k);
    dM.emplace_back((model->mass(q + step) - model->mass(q - step)) / (2.0 * h));
  }
  MatrixJ C = MatrixJ::Zero(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto K = static_cast<std::size_t>(k);
    C += 0.5 * v[k] * dM[K];
    C.col(k) += 0.5 * dM[K] * v;
    C.row(k) -= 0.5 * (dM[K] * v).transpose();
  }
  return C;
}

// One law at one random arm in one random state, pushed by a random wrench.
struct Case {
  Case(const LoadedRobot& robot, const char* law, unsigned seed)
      : generator(seed), bench(robot, law), plant(robot), n(robot.robot.size()) {
    q = random_vector(n, 1.0, generator);
    v = random_vector(n, 0.7, generator);
    bench.set_goal(q + random_vector(n, 0.2, generator));
    bench.goal.v_d = random_vector(n, 0.5, generator);
    bench.goal.a_d = random_vector(n, 2.0, generator);
    bench.goal.V_BD = random_six(0.3, generator);
    bench.goal.A_BD = random_six(1.0, generator);
    bench.gains.settings.damping = bench.gains.settings.joint_damping = DampingDesign::kGiven;
    bench.gains.settings.spring_force_N = bench.gains.settings.spring_moment_Nm = 1e9;
    bench.gains.K_q = random_positive(n, 60.0, generator);
    bench.gains.D_q = random_positive(n, 5.0, generator);
    bench.set("K_acc_per_s2", MatrixJ(random_positive(n, 80.0, generator)));
    bench.set("D_acc_per_s", MatrixJ(random_positive(n, 10.0, generator)));
    bench.gains.K_x = random_stiffness(500.0, 20.0, generator);
    bench.gains.D_x = random_stiffness(30.0, 2.0, generator);
    plant.F_ext = random_six(8.0, generator);
    bench.start(q, v);
  }

  // Of the plant under the law, with the model's bias.
  VectorJ acceleration() { return plant.acceleration(q, v, bench.composed(q, v)); }
  VectorJ tau_ext() const { return plant.terms.J.transpose() * plant.F_ext; }
  Vector6 tip_acceleration() {
    const VectorJ a = acceleration();
    return plant.terms.J * a + plant.terms.Jdot_v;
  }
  // D_x (V - V_d) + A^T K_x e
  Vector6 spring_and_damper() {
    const PoseError error = pose_error(plant.terms.X_BT, bench.goal.X_BD, Orientation::kLog);
    return bench.gains.D_x * (plant.terms.V_BT - bench.goal.V_BD) +
           error.A.transpose() * (bench.gains.K_x * error.e);
  }
  Matrix6 Lambda() const { return (plant.terms.J * plant.terms.Minv_JT).inverse(); }

  std::mt19937 generator;
  LawBench bench;
  Plant plant;
  int n;
  VectorJ q;
  VectorJ v;
};

Case joints_case(const char* law, int n) {
  return {random_arm(n, static_cast<unsigned>(n), n % 2 == 0), law, static_cast<unsigned>(n)};
}

// Six joints or more, at a pose away from singularities.
Case tip_case(const char* law, unsigned seed) {
  const int n = 6 + static_cast<int>(seed) % 11;
  for (unsigned other = 100 * seed;; ++other) {
    const LoadedRobot robot = random_arm(n, other, seed % 2 == 0);
    std::mt19937 generator(seed);  // as Case draws its pose
    const Eigen::MatrixXd J = ArmModel(robot).jacobian(random_vector(n, 1.0, generator));
    if (J.jacobiSvd().singularValues()[5] > 0.1) return {robot, law, seed};
  }
}

TEST(ComputedTorque, ErrorsAreLinearOscillators) {
  for (int n = 1; n <= 16; ++n) {
    Case c = joints_case("computed_torque", n);
    const VectorJ a = c.acceleration();
    const VectorJ expected = c.bench.goal.a_d -
                             c.bench.matrix("K_acc_per_s2") * (c.q - c.bench.goal.q_d) -
                             c.bench.matrix("D_acc_per_s") * (c.v - c.bench.goal.v_d) +
                             c.plant.terms.M_total.llt().solve(c.tau_ext());
    EXPECT_LT((a - expected).norm(), 1e-8 * (1.0 + expected.norm())) << n << " joints";
  }
}

TEST(ComputedTorque, LiteralStiffnessIsMultipliedByTheInertia) {
  Case c = joints_case("computed_torque", 7);
  c.bench.set("literal_stiffness", 1.0);
  const VectorJ a = c.acceleration();
  const MatrixJ K = c.plant.terms.J.transpose() * c.bench.gains.K_x * c.plant.terms.J;
  const VectorJ expected = c.bench.goal.a_d - K * (c.q - c.bench.goal.q_d) -
                           c.bench.matrix("D_acc_per_s") * (c.v - c.bench.goal.v_d) +
                           c.plant.terms.M_total.llt().solve(c.tau_ext());
  EXPECT_LT((a - expected).norm(), 1e-8 * (1.0 + expected.norm()));
}

// M e'' + (C + D) e' + K e = tau_ext: on the goal and without a push the arm stays on it.
TEST(PdPlus, ErrorEquationHoldsAndTrackingIsExact) {
  for (int n = 1; n <= 16; ++n) {
    Case c = joints_case("pd_plus", n);
    const VectorJ a = c.acceleration();
    const VectorJ left =
        c.plant.terms.M_total * (a - c.bench.goal.a_d) +
        (coriolis_matrix(&c.plant.model, c.q, c.v) + c.bench.gains.D_q) * (c.v - c.bench.goal.v_d) +
        c.bench.gains.K_q * (c.q - c.bench.goal.q_d);
    EXPECT_LT((left - c.tau_ext()).norm(), 1e-6 * (1.0 + c.tau_ext().norm())) << n << " joints";
    c.plant.F_ext.setZero();
    c.bench.goal.q_d = c.q;
    c.bench.goal.v_d = c.v;
    EXPECT_LT((c.acceleration() - c.bench.goal.a_d).norm(), 1e-8) << n << " joints";
  }
}

TEST(JointImpedance, HasTheInertiaDampingAndStiffnessAskedFor) {
  for (int n = 1; n <= 16; ++n) {
    Case c = joints_case("joint_impedance", n);
    c.bench.set("M_q_kgm2", MatrixJ(random_positive(n, 0.5, c.generator)));
    c.acceleration();
    c.bench.estimates.tau_ext = c.tau_ext();
    const VectorJ left = c.bench.matrix("M_q_kgm2") * (c.acceleration() - c.bench.goal.a_d) +
                         c.bench.gains.D_q * (c.v - c.bench.goal.v_d) +
                         c.bench.gains.K_q * (c.q - c.bench.goal.q_d);
    EXPECT_LT((left - c.tau_ext()).norm(), 1e-7 * (1.0 + left.norm())) << n << " joints";
  }
}

// A contact that is not seen meets the stiffness M M_d^-1 K.
TEST(JointImpedance, UnseenContactMeetsAnotherStiffness) {
  Case c = joints_case("joint_impedance", 5);
  c.bench.set("M_q_kgm2", MatrixJ(random_positive(5, 0.5, c.generator)));
  c.v.setZero();
  c.bench.goal.v_d.setZero();
  c.bench.goal.a_d.setZero();
  c.bench.goal.q_d = c.q;
  c.acceleration();
  const MatrixJ K =
      c.plant.terms.M_total * c.bench.matrix("M_q_kgm2").inverse() * c.bench.gains.K_q;
  c.bench.goal.q_d -= K.inverse() * c.tau_ext();  // deflected by that much, it rests
  EXPECT_LT(c.acceleration().norm(), 1e-8);
}

TEST(OpspaceImpedance, HasTheInertiaDampingAndStiffnessAskedFor) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    Case c = tip_case("opspace_impedance", seed);
    c.bench.gains.settings.lost_share = 1e-12;
    c.bench.gains.M_x = random_stiffness(3.0, 0.1, c.generator);
    c.bench.estimates.F_ext = c.plant.F_ext;
    c.bench.goal.F_ff = random_six(5.0, c.generator);
    const Vector6 inertial = c.bench.gains.M_x * (c.tip_acceleration() - c.bench.goal.A_BD);
    const Vector6 left = inertial + c.spring_and_damper();
    EXPECT_LT((left - c.plant.F_ext - c.bench.goal.F_ff).norm(), 1e-6 * (1.0 + left.norm()))
        << c.n << " joints";
  }
}

TEST(OpspaceImpedance, WithoutAnInertiaKeepsTheArmsOwnAndNeedsNoForce) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    Case c = tip_case("opspace_impedance", seed);
    c.bench.gains.settings.lost_share = 1e-12;
    const Vector6 V_dot = c.tip_acceleration();
    const Vector6 left = c.Lambda() * (V_dot - c.bench.goal.A_BD) + c.spring_and_damper();
    EXPECT_LT((left - c.plant.F_ext).norm(), 1e-6 * (1.0 + left.norm())) << c.n << " joints";
  }
}

// Over the rows of the task: the planar arm in x and y.
TEST(OpspaceImpedance, ShapesTheTwoRowsOfAPlanarArm) {
  Case c(limber::testing::planar_arm(limber::testing::kDesktop), "opspace_impedance", 3);
  c.q << 0.3, 1.2;
  for (Matrix6* M : {&c.bench.gains.K_x, &c.bench.gains.D_x}) {
    M->rightCols<4>().setZero();
    M->bottomRows<4>().setZero();
  }
  c.bench.gains.M_x.diagonal() << 3.0, 1.0, 0, 0, 0, 0;
  c.plant.F_ext.tail<4>().setZero();  // in the task: what the law cannot see it cannot shape
  c.bench.estimates.F_ext = c.plant.F_ext;
  const Vector6 inertial = c.bench.gains.M_x * (c.tip_acceleration() - c.bench.goal.A_BD);
  const Vector6 left = inertial + c.spring_and_damper() - c.plant.F_ext;
  EXPECT_LT(left.head<2>().norm(), 1e-8 * (1.0 + c.plant.F_ext.norm()));
}

// For as many joints as rows both diagrams are one controller: M_q = J^T M_d J and so on, with the
// curvature J^-1 Jdot v in the joint goal's acceleration.
TEST(OpspaceImpedance, IsTheJointImpedanceOfASquareJacobian) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    if ((6 + seed % 11) != 6) continue;
    Case tip = tip_case("opspace_impedance", seed);
    tip.bench.gains.settings.lost_share = 1e-12;
    tip.bench.gains.M_x = random_stiffness(3.0, 0.1, tip.generator);
    tip.bench.estimates.F_ext = tip.plant.F_ext;
    const VectorJ tau = tip.bench.composed(tip.q, tip.v);
    const ArmTerms& terms = tip.bench.terms;
    const PoseError error = pose_error(terms.X_BT, tip.bench.goal.X_BD, Orientation::kLog);
    const Eigen::Matrix<double, 6, 6> J = terms.J;
    const Eigen::Matrix<double, 6, 6> AJ = error.A * J;

    LawBench joints(tip.bench.robot, "joint_impedance");
    joints.gains = tip.bench.gains;
    joints.set("M_q_kgm2", MatrixJ(J.transpose() * tip.bench.gains.M_x * J));
    joints.gains.D_q = J.transpose() * tip.bench.gains.D_x * J;
    joints.gains.K_q = AJ.transpose() * tip.bench.gains.K_x * AJ;
    joints.goal.q_d = tip.q - AJ.inverse() * error.e;
    joints.goal.v_d = J.inverse() * tip.bench.goal.V_BD;
    joints.goal.a_d = J.inverse() * (tip.bench.goal.A_BD - terms.Jdot_v);
    joints.estimates.tau_ext = J.transpose() * tip.plant.F_ext;
    const VectorJ same = joints.composed(tip.q, tip.v);
    EXPECT_LT((same - tau).norm(), 1e-7 * (1.0 + tau.norm()));
  }
}

// With the acceleration that follows from it fed back, (Lambda + M_x) dV/dt is what remains.
TEST(AccelFeedback, AddsItsInertiaToTheArms) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    Case c = tip_case("accel_feedback", seed);
    c.bench.gains.M_x = random_stiffness(2.0, 0.05, c.generator);
    c.bench.goal.V_BD.setZero();
    c.acceleration();
    const Vector6 F = c.plant.F_ext - c.spring_and_damper() + c.Lambda() * c.plant.terms.Jdot_v;
    const Vector6 expected = (c.Lambda() + c.bench.gains.M_x).inverse() * F;
    c.bench.estimates.A_BT = expected;
    EXPECT_LT((c.tip_acceleration() - expected).norm(), 1e-7 * (1.0 + expected.norm()))
        << c.n << " joints";
  }
}

TEST(CartesianImpedance, FollowsWithoutLagWithInertiaFeedforward) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    Case c = tip_case("cartesian_impedance", seed);
    c.bench.set("inertia_feedforward", 1.0);
    c.bench.gains.settings.lost_share = 1e-12;
    c.bench.goal.F_ff = random_six(5.0, c.generator);
    const Vector6 V_dot = c.tip_acceleration();
    const Vector6 left = c.Lambda() * (V_dot - c.bench.goal.A_BD) + c.spring_and_damper();
    EXPECT_LT((left - c.plant.F_ext - c.bench.goal.F_ff).norm(), 1e-6 * (1.0 + left.norm()))
        << c.n << " joints";
  }
}

TEST(Salisbury, IsASpringOfTheJointsWithConstantDamping) {
  Case c = joints_case("salisbury", 7);
  c.acceleration();
  const Matrix6J& J = c.plant.terms.J;
  const VectorJ expected = -J.transpose() * (c.bench.gains.K_x * (J * (c.q - c.bench.goal.q_d))) -
                           c.bench.gains.D_q * (c.v - c.bench.goal.v_d);
  EXPECT_LT((c.bench.at(c.q, c.v).tau() - expected).norm(), 1e-9 * expected.norm());

  c.bench.gains.settings.joint_damping = DampingDesign::kDoubleDiagonalisation;
  c.bench.start(c.q, c.v);
  const auto damping_at = [&](const VectorJ& q) -> VectorJ {
    return c.bench.at(q, c.v).tau_damping;
  };
  const VectorJ here = damping_at(c.q);
  EXPECT_EQ((damping_at(c.q + VectorJ::Constant(7, 0.5)) - here).norm(), 0.0) << "constant";
  c.bench.gains.K_x *= 4.0;
  EXPECT_LT((damping_at(c.q) - 2.0 * here).norm(), 1e-4 * here.norm()) << "but for new gains";
}

// The slope of what holds the loaded arm: J^-T (K_q - K_G(F_0)) J^-1, which is K_x with the
// geometric term and off by it without. Planar closed form of K_G.
TEST(Eq4, PresentsTheStiffnessUnderLoad) {
  const LoadedRobot robot = limber::testing::planar_arm(limber::testing::kDesktop);
  const auto arm = limber::testing::kDesktop;
  LawBench bench(robot, "congruence_stiffness");
  const VectorJ q = (VectorJ(2) << 0.5, 1.4).finished();
  bench.set_goal(q);
  bench.gains.K_x.setZero();
  bench.gains.K_x.topLeftCorner<2, 2>() << 300.0, 40.0, 40.0, 200.0;
  bench.goal.F_ff.head<2>() << 30.0, -15.0;
  const Vector6 F_0 = -bench.goal.F_ff;  // what the world pushes with
  const Eigen::Vector2d f = F_0.head<2>();
  const Eigen::Vector2d p2 = arm.a2 * Eigen::Vector2d(std::cos(1.9), std::sin(1.9));
  const Eigen::Vector2d p = p2 + arm.a1 * Eigen::Vector2d(std::cos(0.5), std::sin(0.5));
  Eigen::Matrix2d K_G;
  K_G << -p.dot(f), -p2.dot(f), -p2.dot(f), -p2.dot(f);

  const auto presented = [&] {
    constexpr double h = 1e-6;
    Eigen::Matrix2d slope;
    for (int k = 0; k < 2; ++k) {
      const VectorJ step = h * VectorJ::Unit(2, k);
      const auto torque = [&](const VectorJ& at) -> VectorJ {
        const VectorJ tau = bench.at(at, VectorJ::Zero(2)).tau();
        return tau + bench.terms.J.transpose() * F_0;
      };
      slope.col(k) = -(torque(q + step) - torque(q - step)) / (2.0 * h);
    }
    const Eigen::Matrix2d J = bench.model.jacobian(q).topRows<2>();
    return Eigen::Matrix2d(J.transpose().inverse() * slope * J.inverse());
  };
  const Eigen::Matrix2d J = bench.model.jacobian(q).topRows<2>();
  const Eigen::Matrix2d K_x = bench.gains.K_x.topLeftCorner<2, 2>();
  EXPECT_LT((presented() - K_x).norm(), 1e-6 * K_x.norm());
  bench.gains.settings.stiffness_terms = StiffnessTerms::kFirst;
  const Eigen::Matrix2d without = K_x - J.transpose().inverse() * K_G * J.inverse();
  EXPECT_LT((presented() - without).norm(), 1e-6 * K_x.norm());
  EXPECT_GT((without - K_x).norm(), 0.1 * K_x.norm()) << "it matters here";
}

// Between evaluations the force is off in second order of the motion with the full tangent, in
// first order with the first term alone, on an arm that carries a load.
TEST(IncrementalImpedance, ErrorBetweenEvaluationsHasTheOrderOfItsTerms) {
  for (const auto terms : {StiffnessTerms::kFull, StiffnessTerms::kFirst}) {
    Case c = tip_case("multirate_impedance", 1);
    c.bench.gains.settings.stiffness_terms = terms;
    const VectorJ along = random_vector(c.n, 1.0, c.generator);
    const VectorJ rest = VectorJ::Zero(c.n);
    c.bench.goal.V_BD.setZero();
    const auto error = [&](double h) {
      c.bench.due = true;
      c.bench.at(c.q, rest);
      c.bench.due = false;
      const VectorJ moved = c.q + h * along;
      const VectorJ held = holding_torque(&c.plant.model, moved, c.bench.goal.X_BD,
                                          c.bench.gains.K_x, Orientation::kLog);
      return (c.bench.at(moved, rest).tau() + held).norm();
    };
    const double order = std::log2(error(2e-3) / error(1e-3));
    EXPECT_NEAR(order, terms == StiffnessTerms::kFull ? 2.0 : 1.0, 0.1);
  }
}

}  // namespace
}  // namespace limber::controller::test_closed_loop
