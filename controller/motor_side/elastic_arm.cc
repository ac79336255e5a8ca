#include "controller/motor_side/elastic_arm.h"

#include <Eigen/Cholesky>

namespace limber::controller {

ElasticArmRate elastic_arm_rate(const ArmTerms& terms, const ElasticJoints& joints,
                                const VectorJ& q, const VectorJ& v, const VectorJ& theta,
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

}  // namespace limber::controller
