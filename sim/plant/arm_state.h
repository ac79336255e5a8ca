// What moves: links, and the motors behind joint springs.
#pragma once

#include <Eigen/Core>

#include "common/types.h"

namespace limber::sim {

/// One value a motor, in the order of the joints, the antagonist after the first motor of its
/// joint.
using VectorM = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxMotors, 1>;

/// rad, rad/s (prismatic: m, m/s); motors behind the gear. Motors of rigid joints are where their
/// links are.
struct ArmState {
  VectorJ q, v;
  VectorM theta, theta_dot;

  bool finite_and_slower_than(double most) const noexcept {
    return q.allFinite() && theta.allFinite() && v.allFinite() && theta_dot.allFinite() &&
           v.cwiseAbs().maxCoeff() <= most && theta_dot.cwiseAbs().maxCoeff() <= most;
  }
};

}  // namespace limber::sim
