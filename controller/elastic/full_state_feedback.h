// Joint torque feedback as one law on the full state of an elastic joint.
#pragma once

#include "common/types.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// Motor position and joint torque fed back (Albu-Schaeffer, Ott, Hirzinger 2007):
///   tau_m = g - K_P (theta - theta_d) - K_D theta' + K_T (g - tau) - K_S K_J^-1 tau'.
/// Equals torque feedback with rho = B / B_theta (docs/joints.md) around u = g - K_Pu (theta -
/// theta_d) - K_Du theta' for K_T = rho - 1, K_S = (rho - 1) D_J, K_P = rho K_Pu, K_D = rho K_Du.
struct FullStateFeedback {
  MatrixJ K_P;  ///< N m/rad
  MatrixJ K_D;  ///< N m s/rad
  MatrixJ K_T;  ///< 1
  MatrixJ K_S;  ///< N m s/rad
  VectorJ K_J;  ///< N m/rad, > 0

  /// theta_error = theta - theta_d; g_ff: torque the spring shall carry, N m. In the cycle.
  VectorJ torque(const VectorJ& theta_error, const VectorJ& theta_dot, const VectorJ& tau,
                 const VectorJ& tau_dot, const VectorJ& g_ff) const noexcept {
    return g_ff - K_P * theta_error - K_D * theta_dot + K_T * (g_ff - tau) -
           K_S * tau_dot.cwiseQuotient(K_J);
  }
};

}  // namespace limber::controller
#pragma GCC visibility pop
