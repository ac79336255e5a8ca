// Equations of motion of an arm with elastic joints: a model of the arm, which no controller runs.
#pragma once

#include <Eigen/Cholesky>

#include "controller/model/arm_terms.h"

namespace limber::eval {

/// One spring, damper and rotor a joint, behind the gear; n each.
struct ElasticJoints {
  VectorJ K_J;  ///< N m/rad
  VectorJ D_J;  ///< N m s/rad
  VectorJ B;    ///< kg m^2, > 0
};

struct ElasticArmRate {
  VectorJ tau;       ///< spring torque on the link, what a joint torque sensor reads, N m
  VectorJ tau_t;     ///< torque passed on to the link, spring and damper, N m
  VectorJ qdd;       ///< link acceleration, rad/s^2
  VectorJ theta_dd;  ///< motor acceleration, rad/s^2
};

/// M. Spong, Modeling and control of elastic joint robots, 1987 (rotor energy theta'^T B theta' /
/// 2):
///   M q'' + C v + g = tau_t + J^T F_ext,       tau   = K_J (theta - q)
///   B theta'' + tau_t + tau_f = tau_m,         tau_t = tau + D_J (theta' - v)
/// `terms` at (q, v); its M of the links alone is used, its rotors are not. tau_m: motor torque,
/// tau_f: friction at the motor, N m, positive against positive motion. F_ext: N and N m, base axes
/// at the tip. May be called in the cycle.
inline ElasticArmRate elastic_arm_rate(const controller::ArmTerms& terms,
                                       const ElasticJoints& joints, const VectorJ& q,
                                       const VectorJ& v, const VectorJ& theta,
                                       const VectorJ& theta_dot, const VectorJ& tau_m,
                                       const VectorJ& tau_f, const Vector6& F_ext) noexcept {
  ElasticArmRate rate;
  rate.tau = joints.K_J.cwiseProduct(theta - q);
  rate.tau_t = rate.tau + joints.D_J.cwiseProduct(theta_dot - v);
  rate.qdd = rate.tau_t - terms.Cv - terms.g;
  rate.qdd += terms.J.transpose() * F_ext;
  terms.M.llt().solveInPlace(rate.qdd);
  rate.theta_dd = (tau_m - tau_f - rate.tau_t).cwiseQuotient(joints.B);
  return rate;
}

}  // namespace limber::eval
