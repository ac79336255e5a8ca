// Joint gains times a finite joint error: how far from the Cartesian spring, and whether a closed
// path comes back with the energy it went with.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "controller/impedance/stiffness_mapping.h"
#include "tests/controller/arms.h"

namespace limber::controller::test_mapped_joint_impedance {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr limber::testing::PlanarParameters kArm{0.5,        0.4, 0.25, 0.2, 4.0,  2.5, 1.0 / 12.0,
                                                 1.0 / 30.0, 1.0, 1.0,  0.0, 0.01, 0.01};

struct Row {
  const char* name;
  StiffnessTerms terms;
  MappingPose pose;
  int order;  ///< of the relative force error in the deviation
  bool conservative;
};

constexpr Row kRows[] = {
    {"first, current", StiffnessTerms::kFirst, MappingPose::kCurrent, 1, false},
    {"first, goal", StiffnessTerms::kFirst, MappingPose::kGoal, 1, true},
    {"full, current", StiffnessTerms::kFull, MappingPose::kCurrent, 1, true},
    {"first, mid", StiffnessTerms::kFirst, MappingPose::kMid, 1, false},
    {"full, mid", StiffnessTerms::kFull, MappingPose::kMid, 2, true},
    {"full, mean", StiffnessTerms::kFull, MappingPose::kMean, 2, true},
};

class MappedGainsTest : public ::testing::Test {
 protected:
  MappedGainsTest()
      : robot(limber::testing::planar_arm(kArm)), model(robot), gains(2, {}), goal(2) {
    gains.K_x.topLeftCorner<2, 2>().diagonal().setConstant(300.0);
    goal.q_d = (VectorJ(2) << 20.0 * kDegree, 80.0 * kDegree).finished();
    goal.X_BD = model.tip_pose(goal.q_d);
  }

  Eigen::Matrix2d jacobian(const VectorJ& q) { return model.jacobian(q).topRows<2>(); }

  // Newton; the tip `x` away from the goal.
  VectorJ joints_at(const Eigen::Vector2d& x) {
    VectorJ q = goal.q_d;
    for (int i = 0; i < 30; ++i) {
      const Eigen::Vector2d left = (model.tip_pose(q).p - goal.X_BD.p).head<2>() - x;
      q -= jacobian(q).inverse() * left;
    }
    return q;
  }

  VectorJ torque(const Row& row, const VectorJ& q) {
    gains.settings.stiffness_terms = row.terms;
    const MappedGains mapped = mapped_gains(&model, q, VectorJ::Zero(2), goal, gains,
                                            Matrix6::Identity(), {.pose = row.pose});
    return mapped.K_p * (goal.q_d - q);
  }

  double relative_force_error(const Row& row, double deviation) {
    const Eigen::Vector2d x = deviation * Eigen::Vector2d(std::cos(0.7), std::sin(0.7));
    const VectorJ q = joints_at(x);
    const Eigen::Vector2d force = jacobian(q).transpose().inverse() * torque(row, q);
    return (force + 300.0 * x).norm() / (300.0 * deviation);
  }

  // Torque along a circle of 4 cm whose centre is 6 cm from the goal; the trapezoidal rule is exact
  // to rounding on a closed smooth path.
  double work(const Row& row) {
    constexpr int kPoints = 200;
    double sum = 0.0;
    for (int i = 0; i < kPoints; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kPoints;
      const Eigen::Vector2d radius = 0.04 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      const VectorJ q = joints_at(Eigen::Vector2d(0.06, 0.0) + radius);
      const Eigen::Vector2d along(-radius.y(), radius.x());
      sum += torque(row, q).dot(jacobian(q).inverse() * along);
    }
    return sum * 2.0 * std::numbers::pi / kPoints;
  }

  LoadedRobot robot;
  ArmModel model;
  Gains gains;
  Goal goal;
};

TEST_F(MappedGainsTest, ErrorHasTheOrderOfItsRow) {
  for (const Row& row : kRows) {
    const double order =
        std::log2(relative_force_error(row, 2e-3) / relative_force_error(row, 1e-3));
    EXPECT_NEAR(order, row.order, 0.1) << row.name;
  }
}

// -J^T K H[d, d] / 2 with d = q - q_d and H the second derivative of the tip's position.
TEST_F(MappedGainsTest, LeadingErrorOfTheFirstTermAtThePresentPose) {
  const VectorJ q = goal.q_d + (VectorJ(2) << 1e-3, -2e-3).finished();
  const VectorJ d = q - goal.q_d;
  const Eigen::Vector2d p1 = 0.5 * Eigen::Vector2d(std::cos(q[0]), std::sin(q[0]));
  const Eigen::Vector2d p2 = 0.4 * Eigen::Vector2d(std::cos(q[0] + q[1]), std::sin(q[0] + q[1]));
  const Eigen::Vector2d H = -p1 * d[0] * d[0] - p2 * (d[0] + d[1]) * (d[0] + d[1]);
  const Eigen::Vector2d x = (model.tip_pose(q).p - goal.X_BD.p).head<2>();
  const Eigen::Vector2d error = torque(kRows[0], q) + 300.0 * jacobian(q).transpose() * x;
  const Eigen::Vector2d expected = -0.5 * 300.0 * jacobian(q).transpose() * H;
  EXPECT_LT((error - expected).norm(), 1e-2 * expected.norm());
}

TEST_F(MappedGainsTest, ClosedPathReturnsItsEnergyWhereTheRowSaysSo) {
  for (const Row& row : kRows) {
    if (row.conservative) {
      EXPECT_LT(std::abs(work(row)), 1e-7) << row.name;
    } else {
      EXPECT_GT(std::abs(work(row)), 1e-4) << row.name;
    }
  }
}

TEST_F(MappedGainsTest, PartialsGoWhereTheSettingSays) {
  const VectorJ q = goal.q_d + VectorJ::Constant(2, 0.1);
  const VectorJ v = (VectorJ(2) << 0.7, -0.4).finished();
  const Matrix6 D = 20.0 * Matrix6::Identity();
  const auto with = [&](DampingPartials partials) {
    return mapped_gains(&model, q, v, goal, gains, D, {.damping_partials = partials});
  };
  const MappedGains plain = with(DampingPartials::kNone);
  const MappedGains printed = with(DampingPartials::kPrinted);
  const MappedGains in_stiffness = with(DampingPartials::kInStiffness);
  const MatrixJ K_G = geometric_term(model.jacobian(q), D * (model.jacobian(q) * v));
  EXPECT_LT((printed.K_v - plain.K_v - K_G).norm(), 1e-6);
  EXPECT_EQ((printed.K_p - plain.K_p).norm(), 0.0);
  EXPECT_EQ((in_stiffness.K_v - plain.K_v).norm(), 0.0);
  EXPECT_GT((in_stiffness.K_p - plain.K_p).norm(), 0.1);
}

}  // namespace
}  // namespace limber::controller::test_mapped_joint_impedance
