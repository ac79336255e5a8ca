// The motor law that steers the spring's deflection to zero, in one line; the controller's law of
// this name adds the sensors. Kept to show what it does.
#pragma once

#include "common/types.h"

namespace limber::eval {

/// tau_m = -K_pm (theta - q) - K_vm (theta' - q').
/// It has no set-point: this is torque feedback around u = 0 with rho = 1 + K_pm / K_J. The link
/// moves with the inertia M + B / rho, without any stiffness, and falls under gravity.
/// K_pm: n x n, N m/rad; K_vm: n x n, N m s/rad; the rest n. May be called in the cycle.
inline VectorJ deflection_torque(const MatrixJ& K_pm, const MatrixJ& K_vm, const VectorJ& q,
                                 const VectorJ& v, const VectorJ& theta,
                                 const VectorJ& theta_dot) noexcept {
  return -(K_pm * (theta - q)) - K_vm * (theta_dot - v);
}

}  // namespace limber::eval
