// The forward dynamics of the links against closed forms, KDL's inverse dynamics and mechanics' own
// balances.
#include <gtest/gtest.h>

#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainfksolvervel_recursive.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "sim/model/link_dynamics.h"
#include "tests/sim/test_arms.h"

namespace limber::sim::test_link_dynamics {
namespace {

using testing::desktop;
using testing::PlanarSet;
using testing::random_arm;
using testing::random_vector;

KDL::JntArray to_kdl(const VectorJ& q) {
  KDL::JntArray out(static_cast<unsigned>(q.size()));
  out.data = q;
  return out;
}

KDL::Vector to_kdl(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// Textbook closed form of the planar arm; rotors on the diagonal only.
VectorJ planar_torque(const PlanarSet& s, const Eigen::Vector2d& q, const Eigen::Vector2d& v,
                      const Eigen::Vector2d& a) {
  const double g = 9.81;
  const double c2 = std::cos(q[1]);
  const double b11 = s.I1 + s.m1 * s.l1 * s.l1 + s.B1 + s.I2 +
                     s.m2 * (s.a1 * s.a1 + s.l2 * s.l2 + 2 * s.a1 * s.l2 * c2) +
                     s.motor * s.a1 * s.a1;
  const double b12 = s.I2 + s.m2 * (s.l2 * s.l2 + s.a1 * s.l2 * c2);
  const double b22 = s.I2 + s.m2 * s.l2 * s.l2 + s.B2;
  const double h = -s.m2 * s.a1 * s.l2 * std::sin(q[1]);
  const double g2 = s.m2 * s.l2 * g * std::cos(q[0] + q[1]);
  const double g1 = (s.m1 * s.l1 + s.motor * s.a1 + s.m2 * s.a1) * g * std::cos(q[0]) + g2;
  VectorJ tau(2);
  tau << b11 * a[0] + b12 * a[1] + h * v[1] * v[0] + h * (v[0] + v[1]) * v[1] + g1,
      b12 * a[0] + b22 * a[1] - h * v[0] * v[0] + g2;
  return tau;
}

TEST(LinkDynamics, PlanarArmFollowsClosedForm) {
  for (const PlanarSet& s : {desktop(), PlanarSet{1, 1, 0.5, 0.5, 50, 50, 10, 10, 5, 100, 100}}) {
    LinkDynamics arm(build_arm_model(testing::planar_arm(s)));
    std::mt19937 random(1);
    for (int n = 0; n < 200; ++n) {
      const VectorJ q = random_vector(2, 3.0, random);
      const VectorJ v = random_vector(2, 4.0, random);
      const VectorJ a = random_vector(2, 20.0, random);
      VectorJ qdd;
      arm.set_state(q, v);
      arm.accelerations(planar_torque(s, q, v, a), VectorJ::Zero(2), &qdd);
      EXPECT_LT((qdd - a).norm(), 1e-11);
    }
  }
}

TEST(LinkDynamics, PlanarArmHoldsTabulatedGravityTorque) {
  // Worked by hand: horizontal arm, g1 = (1.2*0.175 + 0.3*0.35 + 0.8*0.35) 9.81 + g2, g2 =
  // 0.8*0.15*9.81.
  LinkDynamics arm(build_arm_model(testing::planar_arm(desktop())));
  arm.set_state(VectorJ::Zero(2), VectorJ::Zero(2));
  VectorJ tau(2);
  tau << 7.01415, 1.1772;
  VectorJ qdd;
  arm.accelerations(tau, VectorJ::Zero(2), &qdd);
  EXPECT_LT(qdd.norm(), 1e-12);
  EXPECT_NEAR(arm.link_position(arm.tip()).x(), 0.65, 1e-15);
}

class SpatialArm : public ::testing::TestWithParam<std::pair<int, bool>> {};

TEST_P(SpatialArm, AgreesWithInverseDynamicsOfKdl) {
  const auto [joints, sliders] = GetParam();
  const LoadedRobot robot = random_arm(joints, sliders, 7);
  LinkDynamics arm(build_arm_model(robot));
  const KDL::Vector gravity(robot.robot.gravity[0], robot.robot.gravity[1], robot.robot.gravity[2]);
  KDL::ChainIdSolver_RNE inverse(robot.chain, gravity);
  KDL::ChainDynParam terms(robot.chain, gravity);
  KDL::ChainFkSolverPos_recursive fk(robot.chain);
  const unsigned n = static_cast<unsigned>(joints);
  const unsigned segments = robot.chain.getNrOfSegments();
  std::mt19937 random(2);
  for (int sample = 0; sample < 100; ++sample) {
    const VectorJ q = random_vector(joints, 3.0, random);
    const VectorJ v = random_vector(joints, 2.0, random);
    const VectorJ tau = random_vector(joints, 10.0, random);
    arm.set_state(q, v);
    // A wrench on every link, base axes at the link's origin; KDL wants them in the link's own
    // axes.
    KDL::Wrenches wrenches(segments);
    for (unsigned link = 0; link < segments; ++link) {
      const VectorJ F = random_vector(6, 5.0, random);
      KDL::Frame pose;
      fk.JntToCart(to_kdl(q), pose, static_cast<int>(link) + 1);
      const int index = static_cast<int>(link);
      EXPECT_LT((to_kdl(arm.link_position(index)) - pose.p).Norm(), 1e-12);
      wrenches[link] = pose.M.Inverse() *
                       KDL::Wrench(KDL::Vector(F[0], F[1], F[2]), KDL::Vector(F[3], F[4], F[5]));
      arm.add_wrench(arm.body_of(index), arm.link_position(index), F.head<3>(), F.tail<3>());
    }
    VectorJ qdd;
    arm.accelerations(tau, VectorJ::Zero(joints), &qdd);

    KDL::JntSpaceInertiaMatrix M(n);
    terms.JntToMass(to_kdl(q), M);
    MatrixJ mass = M.data;
    for (int i = 0; i < joints; ++i) mass(i, i) += robot.robot.joints[i].drive.rotor_inertia_kgm2;
    KDL::JntArray kdl_tau(n);
    inverse.CartToJnt(to_kdl(q), to_kdl(v), to_kdl(qdd), wrenches, kdl_tau);
    VectorJ expected = kdl_tau.data;
    for (int i = 0; i < joints; ++i) {
      expected[i] += robot.robot.joints[i].drive.rotor_inertia_kgm2 * qdd[i];
    }
    const double largest = std::max(tau.cwiseAbs().maxCoeff(), (mass * qdd).cwiseAbs().maxCoeff());
    EXPECT_LT((expected - tau).cwiseAbs().maxCoeff(), 1e-12 * largest);

    // Wrenches and torques enter alike: the torque of the wrenches alone has the same effect.
    const VectorJ torque_of_wrenches = arm.wrench_torque();
    arm.clear_wrenches();
    VectorJ again;
    arm.accelerations(tau + torque_of_wrenches, VectorJ::Zero(joints), &again);
    EXPECT_LT((again - qdd).norm(), 1e-8 * (1.0 + qdd.norm()));
    EXPECT_NEAR(arm.kinetic_energy(), 0.5 * v.dot(mass * v), 1e-12 * v.dot(mass * v));
  }
}

TEST_P(SpatialArm, LinkVelocitiesAgreeWithKdl) {
  const auto [joints, sliders] = GetParam();
  const LoadedRobot robot = random_arm(joints, sliders, 8);
  LinkDynamics arm(build_arm_model(robot));
  KDL::ChainFkSolverVel_recursive fk(robot.chain);
  std::mt19937 random(3);
  const VectorJ q = random_vector(joints, 3.0, random);
  const VectorJ v = random_vector(joints, 2.0, random);
  arm.set_state(q, v);
  for (int link = 0; link <= arm.tip(); ++link) {
    KDL::FrameVel frame;
    fk.JntToCart(KDL::JntArrayVel(to_kdl(q), to_kdl(v)), frame, link + 1);
    EXPECT_LT((to_kdl(arm.link_velocity(link)) - frame.p.v).Norm(), 1e-12);
    EXPECT_LT((to_kdl(arm.link_angular_velocity(link)) - frame.M.w).Norm(), 1e-12);
    const KDL::Vector x = frame.M.R.UnitX();
    EXPECT_LT((to_kdl(Eigen::Vector3d(arm.link_rotation(link).col(0))) - x).Norm(), 1e-12);
  }
}

TEST_P(SpatialArm, ExtraInertiaActsLikeARotor) {
  const auto [joints, sliders] = GetParam();
  LoadedRobot robot = random_arm(joints, sliders, 9);
  LinkDynamics with_extra(build_arm_model(robot));
  for (JointConfig& joint : robot.robot.joints) joint.drive.rotor_inertia_kgm2 += 0.3;
  LinkDynamics with_rotor(build_arm_model(robot));
  std::mt19937 random(4);
  const VectorJ q = random_vector(joints, 3.0, random);
  const VectorJ v = random_vector(joints, 2.0, random);
  const VectorJ tau = random_vector(joints, 9.0, random);
  VectorJ a;
  VectorJ b;
  with_extra.set_state(q, v);
  with_rotor.set_state(q, v);
  with_extra.accelerations(tau, VectorJ::Constant(joints, 0.3), &a);
  with_rotor.accelerations(tau, VectorJ::Zero(joints), &b);
  EXPECT_LT((a - b).norm(), 1e-10);
}

INSTANTIATE_TEST_SUITE_P(Sizes, SpatialArm,
                         ::testing::Values(std::pair(1, false), std::pair(2, true),
                                           std::pair(7, false), std::pair(7, true),
                                           std::pair(16, true)));

TEST(LinkDynamics, PotentialEnergyIsTheIntegralOfGravityTorque) {
  const LoadedRobot robot = random_arm(5, true, 10);
  LinkDynamics arm(build_arm_model(robot));
  KDL::ChainDynParam terms(robot.chain, KDL::Vector(robot.robot.gravity[0], robot.robot.gravity[1],
                                                    robot.robot.gravity[2]));
  std::mt19937 random(5);
  const VectorJ q = random_vector(5, 2.0, random);
  KDL::JntArray g(5);
  terms.JntToGravity(to_kdl(q), g);
  const double step = 1e-5;
  for (int i = 0; i < 5; ++i) {
    VectorJ up = q;
    VectorJ down = q;
    up[i] += step;
    down[i] -= step;
    arm.set_state(up, VectorJ::Zero(5));
    const double high = arm.potential_energy();
    arm.set_state(down, VectorJ::Zero(5));
    EXPECT_NEAR((high - arm.potential_energy()) / (2 * step), g(static_cast<unsigned>(i)), 1e-7);
  }
}

TEST(LinkDynamics, TipLoadWeighsWhatItShould) {
  LinkDynamics arm(build_arm_model(testing::planar_arm(desktop())));
  arm.set_tip_load(2.0, Eigen::Vector3d(0.1, 0.0, 0.0));
  arm.set_state(VectorJ::Zero(2), VectorJ::Zero(2));
  VectorJ tau(2);
  tau << 7.01415 + 2.0 * 9.81 * 0.75, 1.1772 + 2.0 * 9.81 * 0.4;
  VectorJ qdd;
  arm.accelerations(tau, VectorJ::Zero(2), &qdd);
  EXPECT_LT(qdd.norm(), 1e-11);

  // Spun about the elbow it adds m r^2.
  VectorJ v(2);
  v << 0.0, 3.0;
  arm.set_state(VectorJ::Zero(2), v);
  const double loaded = arm.kinetic_energy();
  arm.set_tip_load(0.0, Eigen::Vector3d::Zero());
  arm.set_state(VectorJ::Zero(2), v);
  EXPECT_NEAR(loaded - arm.kinetic_energy(), 0.5 * 2.0 * 0.4 * 0.4 * 9.0, 1e-12);
}

}  // namespace
}  // namespace limber::sim::test_link_dynamics
