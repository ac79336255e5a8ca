// Joint torque feedback: makes a motor lighter and its friction smaller than they are.
#pragma once

#include "common/types.h"

namespace limber::controller {

/// Motor inertia scaling (Ott, Albu-Schaeffer, Kugi, Hirzinger 2008):
///   tau_m = rho u + (1 - rho) tau_t,   rho = B / B_theta,   tau_t = tau + D_J K_J^-1 tau'
/// turns B theta'' + tau_t + tau_f = tau_m into B_theta theta'' + tau_t + tau_f / rho = u: whatever
/// law u moves a motor of inertia B_theta. Sampled at T with the delay t_d and motor damping d it
/// is stable for rho - 1 < d / (K_J (T/2 + t_d)). All n; behind the gear.
struct TorqueFeedback {
  VectorJ B;        ///< rotor inertia, kg m^2
  VectorJ B_theta;  ///< what it shall seem, kg m^2, > 0
  VectorJ K_J;      ///< joint springs, N m/rad, > 0
  VectorJ D_J;      ///< joint dampers, N m s/rad

  /// u, tau: N m; tau_dot: N m/s, measured or K_J (theta' - q'). May be called in the cycle.
  VectorJ torque(const VectorJ& u, const VectorJ& tau, const VectorJ& tau_dot) const noexcept {
    const VectorJ rho = B.cwiseQuotient(B_theta);
    const VectorJ tau_t = tau + D_J.cwiseProduct(tau_dot).cwiseQuotient(K_J);
    return tau_t + rho.cwiseProduct(u - tau_t);
  }
};

/// The same as one law on the full state of the joint (Albu-Schaeffer, Ott, Hirzinger 2007):
///   tau_m = g - K_P (theta - theta_d) - K_D theta' + K_T (g - tau) - K_S K_J^-1 tau'.
/// Equals TorqueFeedback around u = g - K_Pu (theta - theta_d) - K_Du theta' for K_T = rho - 1,
/// K_S = (rho - 1) D_J, K_P = rho K_Pu, K_D = rho K_Du.
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
