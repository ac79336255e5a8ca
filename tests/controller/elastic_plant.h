// An arm whose motors move it through springs.
#pragma once

#include <Eigen/Cholesky>

#include "controller/model/arm_terms.h"
#include "robots/loader/load_robot.h"

namespace limber::testing {

/// M q'' + C v + g = tau_t + J^T F_ext,  B theta'' + tau_t = tau,  tau_t = spring + D (theta' - v);
/// pairs of motors: equilibrium theta and preload c, each with the inertia of both motors. Linear
/// springs for elastic joints, taut quadratic ones for pairs. Symplectic Euler in small steps,
/// the arm's terms once a call.
class ElasticPlant {
 public:
  explicit ElasticPlant(const LoadedRobot& robot);

  /// At rest at q, the motors where the springs carry the weight; pairs wound up half as far as at
  /// rest.
  void rest_at(const VectorJ& q_at);
  void advance(double dt, const VectorJ& tau, const VectorJ& tau_preload);
  double joint_torque(Eigen::Index i) const { return stiffness(i) * (theta[i] - q[i]); }
  double stiffness(Eigen::Index i) const { return K_[i] + 2.0 * k2_[i] * c[i]; }

  VectorJ q, v, theta, theta_dot, c, c_dot;
  VectorJ tau_f;  ///< friction of the motors, N m; none unless set
  Vector6 F_ext = Vector6::Zero();

 private:
  void step(double h, const Eigen::LLT<MatrixJ>& M, const VectorJ& tau, const VectorJ& tau_preload);

  controller::ArmModel model_;
  controller::ArmTerms terms_;
  VectorJ K_, k2_, D_, B_, preload_;
};

}  // namespace limber::testing
