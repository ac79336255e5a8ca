// External joint torque without differentiating a velocity.
#pragma once

#include "common/types.h"

namespace limber::controller {

/// Momentum residual (De Luca and Mattone 2003):
///   r = K_O (p - p(0) - integral of (tau + beta + r) dt),   p = M v,   beta = C^T v - g,
/// so that dr/dt = K_O (tau_ext - r): a first-order filter of the external torque. Sampled:
///   acc_0 = p_0, r_0 = 0;   acc_k = acc_{k-1} + T (tau + beta + r)_{k-1},  r_k = K_O (p_k - acc_k)
/// with pole 1 - K_O T. What tau leaves out is in r too, with its sign: with the motor's torque
/// (and p with rotors) that is the motor's friction, with a joint torque sensor (and p of the links
/// alone) only the friction behind the sensor. A sample that is not finite is left out.
class MomentumObserver {
 public:
  /// K_O: n, rad/s. T in s. Throws ConfigError unless 0 < K_O T < 2 for every joint.
  MomentumObserver(const VectorJ& K_O, double T);

  /// The next sample is the first. May be called in the cycle.
  void reset() noexcept;

  /// p: kg m^2/s; tau: torque at the joint from this sample to the next, N m; beta: N m; n each.
  /// Returns r, which does not depend on this sample's tau and beta. May be called in the cycle.
  const VectorJ& update(const VectorJ& p, const VectorJ& tau, const VectorJ& beta) noexcept;

  const VectorJ& residual() const noexcept { return r_; }

 private:
  VectorJ K_O_;
  double T_;
  VectorJ acc_;
  VectorJ rate_;  // tau + beta + r of the sample before
  VectorJ r_;
  bool started_ = false;
};

}  // namespace limber::controller
