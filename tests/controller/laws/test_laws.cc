// What each law promises, by physics: potentials, statics, dynamics, energy.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/LU>
#include <cmath>

#include "controller/impedance/nullspace.h"
#include "controller/model/pose_error.h"
#include "controller/model/rotation.h"
#include "controller/model/spring_limit.h"
#include "robots/loader/load_robot.h"
#include "tests/controller/law_bench.h"

namespace limber::controller::test_laws {
namespace {

using limber::testing::LawBench;
using limber::testing::random_six;
using limber::testing::random_vector;

LoadedRobot seven() { return limber::testing::seven_joint_arm(); }
LoadedRobot planar() { return limber::testing::planar_arm(limber::testing::kDesktop); }

VectorJ bent(int n) { return VectorJ::Constant(n, 0.6); }

// Where the arm comes to rest under a small wrench: Newton on the law's static torque, with the
// posture spring in the null space so that a redundant arm has one answer.
VectorJ equilibrium(LawBench* bench, const Vector6& F_ext, const VectorJ& start) {
  const auto n = start.size();
  const TaskRows rows(bench->gains.K_x);
  const auto residual = [&](const VectorJ& q) -> Eigen::VectorXd {
    const VectorJ spring = bench->at(q, VectorJ::Zero(n)).tau();
    const VectorJ posture =
        null_space_projector(bench->terms, rows, Projector::kDynamic) * (-10.0 * (q - start));
    return spring + posture + bench->terms.J.transpose() * F_ext;
  };
  constexpr double h = 1e-6;
  VectorJ q = start;
  for (int i = 0; i < 12; ++i) {
    Eigen::MatrixXd slope(n, n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const VectorJ step = h * VectorJ::Unit(n, k);
      slope.col(k) = (residual(q + step) - residual(q - step)) / (2 * h);
    }
    q -= slope.completeOrthogonalDecomposition().solve(residual(q));
  }
  EXPECT_LT(residual(q).norm(), 1e-11);
  return q;
}

TEST(Registry, NamesAreUniqueAndFound) {
  for (std::size_t i = 0; i < laws().size(); ++i) {
    EXPECT_EQ(find_law(laws()[i].name), static_cast<int>(i));
    EXPECT_NE(laws()[i].summary[0], '\0');
  }
  EXPECT_EQ(find_law(""), -1);
  EXPECT_EQ(find_law("cartesian"), -1);
}

TEST(Registry, ALawIsRefusedWhereASensorIsMissing) {
  LawEntry entry = laws()[0];
  const unsigned have = sensors_of(seven().robot);
  EXPECT_EQ(check_law(entry, have), nullptr);
  for (const unsigned sensor : {sensors::kTorqueSensor, sensors::kTipForceSensor}) {
    entry.needs = sensors::kLinkEncoder | sensor;
    EXPECT_NE(check_law(entry, have), nullptr);
    EXPECT_EQ(check_law(entry, have | sensor), nullptr);
  }
  for (const unsigned sensor : {sensors::kLinkEncoder, sensors::kMotorEncoder}) {
    entry.needs = sensor;
    EXPECT_NE(check_law(entry, have & ~sensor), nullptr);
  }
}

TEST(GravityCompensation, AddsNothingToTheWeight) {
  LawBench bench(seven(), "gravity_compensation");
  EXPECT_EQ(bench.at(bent(7), bent(7)).tau().norm(), 0.0);
}

// tau = -dU/dq with U the energy the law reports, for every law with a spring, both orientation
// errors, springs with coupling, near the goal and beyond the force limit.
TEST(Springs, TorqueIsTheGradientOfTheEnergy) {
  std::mt19937 generator(1);
  constexpr double h = 1e-6;
  for (const char* name : {"joint_pd", "cartesian_impedance"}) {
    for (const LoadedRobot& robot : {seven(), planar()}) {
      LawBench bench(robot, name);
      const int n = robot.robot.size();
      const VectorJ rest = VectorJ::Zero(n);
      for (int i = 0; i < 40; ++i) {
        bench.gains.settings.orientation = i % 2 == 0 ? Orientation::kLog : Orientation::kQuat;
        bench.gains.K_x = limber::testing::random_stiffness(400.0, 20.0, generator);
        bench.set_goal(bent(n) + random_vector(n, 0.3, generator));
        const VectorJ q = bent(n) + random_vector(n, i < 30 ? 0.3 : 1.0, generator);
        VectorJ gradient(n);
        for (int k = 0; k < n; ++k) {
          const VectorJ step = h * VectorJ::Unit(n, k);
          const double plus = bench.at(q + step, rest).spring_energy_J;
          const double minus = bench.at(q - step, rest).spring_energy_J;
          gradient[k] = (plus - minus) / (2 * h);
        }
        const VectorJ tau = bench.at(q, rest).tau();
        EXPECT_LT((tau + gradient).norm(), 1e-6 * (1.0 + tau.norm())) << name << " case " << i;
        EXPECT_GT(tau.norm(), 0.1);
      }
    }
  }
}

TEST(Springs, ForceIsLimitedWithoutAnEdge) {
  LawBench bench(seven(), "cartesian_impedance");
  bench.set_goal(bent(7));
  Pose far = bench.goal.X_BD;
  double last = 0.0;
  for (double x = 0.0; x < 2.0; x += 1e-3) {
    bench.goal.X_BD.p = far.p + Eigen::Vector3d(x, 0, 0);
    const LawOutput& out = bench.at(bent(7), VectorJ::Zero(7));
    EXPECT_NEAR(out.F[0], std::min(500.0 * x, bench.gains.settings.spring_force_N), 1e-6);
    EXPECT_LE(out.F[0] - last, 500.0 * 1e-3 + 1e-9);
    if (std::abs(x - 0.2) > 1e-9) {
      EXPECT_EQ(out.limits != 0, x > 0.2);
    }
    last = out.F[0];
  }
}

// The deflection of the resting arm under a small wrench is K_x^-1 F, in all six directions.
TEST(CartesianImpedance, StaticStiffnessIsWhatWasAskedFor) {
  for (const LoadedRobot& robot : {seven(), load_robot("openarm")}) {
    LawBench bench(robot, "cartesian_impedance");
    const int n = robot.robot.size();
    std::mt19937 generator(2);
    bench.gains.K_x = limber::testing::random_stiffness(500.0, 20.0, generator);
    VectorJ q0 = bent(n);
    if (robot.robot.name == "openarm") {
      for (int i = 0; i < n; ++i) q0[i] = robot.robot.joints[static_cast<std::size_t>(i)].home;
    }
    bench.set_goal(q0);
    Matrix6 e;
    constexpr double kSmall = 1e-5;
    for (int i = 0; i < 6; ++i) {
      const VectorJ plus = equilibrium(&bench, kSmall * Vector6::Unit(i), q0);
      const VectorJ minus = equilibrium(&bench, -kSmall * Vector6::Unit(i), q0);
      e.col(i) = (pose_error(bench.model.tip_pose(plus), bench.goal.X_BD, Orientation::kLog).e -
                  pose_error(bench.model.tip_pose(minus), bench.goal.X_BD, Orientation::kLog).e) /
                 (2 * kSmall);
    }
    const Matrix6 K = e.inverse();
    EXPECT_LT((K - bench.gains.K_x).norm(), 1e-6 * bench.gains.K_x.norm()) << robot.robot.name;
  }
}

TEST(CartesianImpedance, PlanarArmIsAsStiffAsItsTwoRowsSay) {
  for (const LoadedRobot& robot : {planar(), load_robot("desktop2r")}) {
    LawBench bench(robot, "cartesian_impedance");
    bench.gains.K_x.setZero();
    bench.gains.K_x.topLeftCorner<2, 2>() << 700.0, 150.0, 150.0, 300.0;
    VectorJ q0(2);
    q0 << 0.4, 1.1;
    bench.set_goal(q0);
    for (int axis = 0; axis < 2; ++axis) {
      const Vector6 F = 1e-4 * Vector6::Unit(axis);
      const VectorJ q = equilibrium(&bench, F, q0);
      const Eigen::Vector3d moved = bench.model.tip_pose(q).p - bench.goal.X_BD.p;
      const Eigen::Vector2d expected =
          bench.gains.K_x.topLeftCorner<2, 2>().inverse() * F.head<2>();
      EXPECT_LT((moved.head<2>() - expected).norm(), 1e-6 * expected.norm());
    }
  }
}

TEST(JointImpedance, TipComplianceFollowsFromTheJoints) {
  LawBench bench(seven(), "joint_pd");
  bench.gains.K_q.diagonal() << 80, 70, 60, 50, 30, 20, 10;
  const MatrixJ C_q = bench.gains.K_q.inverse();
  bench.set_goal(bent(7));
  bench.at(bent(7), VectorJ::Zero(7));
  const Matrix6 C = bench.terms.J * C_q * bench.terms.J.transpose();
  constexpr double kSmall = 1e-5;
  for (int i = 0; i < 6; ++i) {
    const auto settled = [&](double sign) {
      const Vector6 F = sign * kSmall * Vector6::Unit(i);
      VectorJ q = bent(7);
      for (int k = 0; k < 60; ++k) {  // K_q (q - q_d) = J(q)^T F
        bench.at(q, VectorJ::Zero(7));
        const VectorJ torque = bench.terms.J.transpose() * F;
        q = bent(7) + C_q * torque;
      }
      EXPECT_LT((bench.at(q, VectorJ::Zero(7)).tau() + bench.terms.J.transpose() * F).norm(),
                1e-14);
      return pose_error(bench.model.tip_pose(q), bench.goal.X_BD, Orientation::kLog).e;
    };
    const Vector6 column = (settled(1.0) - settled(-1.0)) / (2 * kSmall);
    EXPECT_LT((column - C.col(i)).norm(), 1e-6 * C.col(i).norm());
  }
}

// The arm under the whole law answers an external wrench as a mass, spring and damper:
// Lambda (dV - Jdot v) + D_x V + A^T K_x e = F_ext + F_ff, whatever it does in its null space.
TEST(CartesianImpedance, TipMovesAsMassSpringDamper) {
  std::mt19937 generator(3);
  for (int i = 0; i < 20; ++i) {
    LawBench bench(seven(), "cartesian_impedance");
    limber::testing::Plant plant(seven());
    bench.gains.K_x = limber::testing::random_stiffness(500.0, 20.0, generator);
    bench.set_goal(bent(7) + random_vector(7, 0.05, generator));
    bench.goal.V_BD = random_six(0.2, generator);
    bench.goal.F_ff = random_six(3.0, generator);
    const VectorJ q = bent(7);
    const VectorJ v = random_vector(7, 0.5, generator);
    plant.F_ext = random_six(5.0, generator);
    const LawOutput& out = bench.at(q, v);
    const VectorJ posture =
        null_space_projector(bench.terms, TaskRows(bench.gains.K_x), Projector::kDynamic) *
        random_vector(7, 5.0, generator);
    EXPECT_GT(posture.norm(), 0.01);
    const VectorJ a =
        plant.acceleration(q, v, out.tau() + posture + bench.terms.g + bench.terms.Cv);
    const Vector6 V_dot = plant.terms.J * a + plant.terms.Jdot_v;
    const Matrix6 Lambda = (plant.terms.J * plant.terms.Minv_JT).inverse();
    const Vector6 inertial = Lambda * (V_dot - plant.terms.Jdot_v);
    EXPECT_LT((inertial - out.F - plant.F_ext).norm(), 1e-9 * (1.0 + out.F.norm()));

    const PoseError error = pose_error(plant.terms.X_BT, bench.goal.X_BD, Orientation::kLog);
    const Vector6 spring = error.A.transpose() * bench.gains.K_x * error.e;
    const Vector6 damping = bench.goal.F_ff - spring - out.F;
    EXPECT_GT(damping.dot(plant.terms.V_BT - bench.goal.V_BD), 0.0);
  }
}

// Closed loop in continuous time with gravity compensation only: kinetic plus spring energy never
// rises, from wild starts, for a redundant and a planar arm, and it does fall.
TEST(Springs, EnergyNeverRises) {
  std::mt19937 generator(4);
  for (const char* name : {"joint_pd", "cartesian_impedance"}) {
    for (const LoadedRobot& robot : {seven(), planar()}) {
      const int n = robot.robot.size();
      LawBench bench(robot, name);
      bench.gains.K_x = limber::testing::random_stiffness(400.0, 15.0, generator);
      bench.set_goal(bent(n));
      limber::testing::Plant plant(robot);
      plant.q = bent(n) + random_vector(n, 0.4, generator);
      plant.v = random_vector(n, 1.0, generator);
      const auto energy = [&] {
        return plant.kinetic_energy() + bench.at(plant.q, plant.v).spring_energy_J;
      };
      const double start = energy();
      double last = start;
      for (int i = 0; i < 1500; ++i) {
        plant.advance(5e-4,
                      [&](const VectorJ& q, const VectorJ& v) { return bench.with_gravity(q, v); });
        const double now = energy();
        ASSERT_LE(now, last + 1e-9 * start) << name << ", " << n << " joints, step " << i;
        last = now;
      }
      EXPECT_LT(last, 0.5 * start) << name;
    }
  }
}

// What is asked of the law after a ramp of the stiffness must be the same as from the start.
TEST(CartesianImpedance, FollowsItsGains) {
  LawBench bench(seven(), "cartesian_impedance");
  bench.set_goal(bent(7) + VectorJ::Constant(7, 0.1));
  bench.at(bent(7), bent(7));
  bench.gains.K_x *= 3.0;
  bench.gains.damping_ratio = 0.3;
  const VectorJ tau = bench.at(bent(7), bent(7)).tau();
  LawBench fresh(seven(), "cartesian_impedance");
  fresh.goal = bench.goal;
  fresh.gains = bench.gains;
  EXPECT_EQ(fresh.at(bent(7), bent(7)).tau(), tau);
}

TEST(CartesianImpedance, StaysBoundedThroughASingularity) {
  LawBench bench(planar(), "cartesian_impedance");
  bench.set_goal((VectorJ(2) << 0.2, 0.3).finished());
  VectorJ before;
  for (double elbow = 0.2; elbow > -0.2; elbow -= 1e-4) {  // through the stretched arm
    const VectorJ tau =
        bench.at((VectorJ(2) << 0.2, elbow).finished(), (VectorJ(2) << 0.5, -1.0).finished()).tau();
    ASSERT_TRUE(tau.allFinite());
    ASSERT_LT(tau.norm(), 100.0);
    if (before.size() > 0) {
      ASSERT_LT((tau - before).norm(), 0.05) << "at " << elbow;
    }
    before = tau;
  }
}

}  // namespace
}  // namespace limber::controller::test_laws
