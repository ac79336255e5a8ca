// Motor position control of an elastic joint arm that needs no sensor but the motor's encoder.
#pragma once

#include "common/types.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// P. Tomei, A simple PD controller for robots with elastic joints, 1991:
///   tau_m = g(q_d) - K_P (theta - theta_d) - K_D theta',   theta_d = q_d + K_J^-1 g(q_d).
/// Constant gravity compensation; the link comes to rest at q_d from anywhere if lambda_min()
/// exceeds the greatest |dg/dq| of the arm. theta, theta_dot: motor side behind the gear.
struct Tomei {
  MatrixJ K_P;  ///< n x n, N m/rad
  MatrixJ K_D;  ///< n x n, N m s/rad
  VectorJ K_J;  ///< joint springs, N m/rad

  /// Motor position at which the springs carry the link at q_d; g_d = g(q_d), N m. In the cycle.
  VectorJ theta_d(const VectorJ& q_d, const VectorJ& g_d) const noexcept {
    return q_d + g_d.cwiseQuotient(K_J);
  }

  /// May be called in the cycle.
  VectorJ torque(const VectorJ& theta, const VectorJ& theta_dot, const VectorJ& q_d,
                 const VectorJ& g_d) const noexcept {
    return g_d - K_P * (theta - theta_d(q_d, g_d)) - K_D * theta_dot;
  }

  /// Smallest eigenvalue of [K_J, -K_J; -K_J, K_J + K_P], N m/rad: above sup |dg/dq| is sufficient
  /// for global regulation. Behind torque feedback K_P is the gain inside u. For set-up.
  double lambda_min() const noexcept;
};

/// A posture that gravity does not leave: the exact condition near q_d asks the series stiffness
/// (K_P^-1 + K_J^-1)^-1 for more than -dg/dq, for one joint K_P > alpha K_J / (K_J - alpha).
/// K_J <= alpha cannot be held by any K_P (infinity). alpha >= 0, K_J > 0, N m/rad.
double critical_motor_gain(double K_J, double alpha) noexcept;

}  // namespace limber::controller
#pragma GCC visibility pop
