// Friction between a motor and its joint torque sensor.
#pragma once

#include "common/types.h"

namespace limber::controller {

/// Per motor, with B theta'' + tau_t + tau_f = tau_m (Le Tien, Albu-Schaeffer, De Luca, Hirzinger,
/// IROS 2008):
///   tau_f^ = z - L B theta',   z <- z + T L (tau_m - tau_t - tau_f^),   z_0 = L B theta'_0,
/// so that the estimate follows tau_f through L / (s + L). Noise of theta' appears as L B times it.
/// A sample that is not finite is left out.
class FrictionObserver {
 public:
  /// B: rotor inertia behind the gear, kg m^2; L: rad/s; n each. T in s. Throws ConfigError unless
  /// B > 0 and 0 < L T < 2 for every joint.
  FrictionObserver(const VectorJ& B, const VectorJ& L, double T);

  /// The next sample is the first. May be called in the cycle.
  void reset() noexcept;

  /// theta_dot: motor velocity behind the gear, rad/s; tau_m: motor torque until the next sample;
  /// tau_t: torque passed on to the link, N m. Returns the estimate, N m, positive against positive
  /// motion: add it to tau_m to compensate. It does not depend on this sample's torques. May be
  /// called in the cycle.
  const VectorJ& update(const VectorJ& theta_dot, const VectorJ& tau_m,
                        const VectorJ& tau_t) noexcept;

  const VectorJ& friction() const noexcept { return tau_f_; }

 private:
  VectorJ LB_;
  VectorJ TL_;
  VectorJ z_;
  VectorJ tau_f_;
  bool started_ = false;
};

}  // namespace limber::controller
