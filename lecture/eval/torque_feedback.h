// Joint torque feedback: makes a motor lighter and its friction smaller than they are. The drives
// run it (sim/nodes/joint_torque_loop.h in simulation), not the controller.
#pragma once

#include "common/types.h"

namespace limber::eval {

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

}  // namespace limber::eval
