// An arm of two joints before LoadWatch, in numbers that are exact.
#pragma once

#include <gtest/gtest.h>

#include "controller/watches/load_watch.h"

namespace limber::controller::load_bench {

inline constexpr double kStep_s = 1.0 / 64.0;
inline constexpr double kFriction_Nm = 0.5;
inline constexpr double kLimit_Nm = 8.0;
inline constexpr double kRate_Nm_per_s = 40.0;

inline Robot two_joints() {
  Robot robot;  // gravity along -z
  robot.joints.resize(2);
  for (JointConfig& joint : robot.joints) {
    joint.torque_limit_Nm = kLimit_Nm;  // a twentieth is less than the friction
    joint.torque_rate_limit_Nm_per_s = kRate_Nm_per_s;
    joint.friction.coulomb_Nm = kFriction_Nm;
  }
  return robot;
}

inline VectorJ vector(double a, double b) {
  VectorJ out(2);
  out << a, b;
  return out;
}

/// At rest, unless told otherwise: weight 2 and 1 N m, tip 0.5 and 0.25 m in front of the joints.
struct Bench {
  explicit Bench(const Robot& robot = two_joints()) : watch(robot) {
    M << 0.5, 0.1, 0.1, 0.2;
    J.row(2) << 0.5, 0.25;
    state.num_joints = 2;
    state.period_ns = std::int64_t{1'000'000'000} / 64;
    watch.begin();
  }
  int next(double dt_s = kStep_s) { return watch.wrong(state, {g, Cv, M, B, J, walls}, dt_s); }
  void apply(const VectorJ& tau) { Eigen::Map<VectorJ>(state.tau_applied, 2) = tau; }
  /// The joint that is found within half a second of this torque from outside, -1: none.
  int found(const VectorJ& outside_Nm) {
    apply(g - outside_Nm);
    for (int k = 0; k < 32; ++k)
      if (const int joint = next(); joint >= 0) return joint;
    EXPECT_NEAR((watch.residual() - outside_Nm).norm(), 0.0, 1e-9);
    return -1;
  }

  /// What is found when it is as it is for as long as it has to: two steps.
  int lasting() {
    EXPECT_EQ(next(), -1);
    return next();
  }

  LoadWatch watch;
  joint_state_t state{};
  VectorJ g = vector(2.0, 1.0);
  VectorJ Cv = vector(0.0, 0.0);
  VectorJ B = vector(0.1, 0.05);
  MatrixJ M = MatrixJ::Zero(2, 2);
  Matrix6J J = Matrix6J::Zero(6, 2);
  VectorJ walls = vector(0.0, 0.0);
};

}  // namespace limber::controller::load_bench
