// Damping at the motor for a link behind a spring, so that the link swings with the ratio asked.
//
//   M q''     = tau_t,   tau_t = K_J (theta - q) + D_J (theta' - q')
//   B theta'' = -tau_t - k x(t - t_d) - D theta'(t - t_d)
//
// x = theta for PositionFeedback::kMotor and kStatic, x = q for kLink; k is the law's stiffness
// there: that asked of the link, K, for kMotor and kLink, and for kStatic what makes K in series
// with the spring, k = K K_J / (K_J - K). B is the rotor as the drive's torque loop makes it seem,
// t_d = 1.5 T: a cycle to the motor and half a cycle held.
//
// With exp(-s t_d) = 1 - s t_d + (s t_d)^2 / 2, right for the slow pair of roots, which is what one
// sees of the link,
//   r = B - D t_d + k t_d^2 / 2,   d = D - k t_d
//   M r s^4 + (M (D_J + d) + D_J r) s^3 + (M (K_J + k) + D_J d + K_J r) s^2
//     + (D_J k + K_J d) s + K_J k = 0                                           kMotor, kStatic
// For a motor without mass and t_d = 0 this is M s^2 (K_J + k + D s) + K_J (k + D s) = 0, whose
// pair is damped by at most (sqrt(1 + K_J / k) - 1) / 2: a stiffer D holds the motor and leaves the
// link to its spring.
#pragma once

#include "controller/kinds/law_settings.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// Linear: kg, N s/m, N/m; for rotations read kg m^2, N m s/rad, N m/rad.
struct ElasticMode {
  double link = 0.0;     ///< M
  double rotor = 0.0;    ///< B
  double spring = 0.0;   ///< K_J
  double damper = 0.0;   ///< D_J
  double law = 0.0;      ///< k, see law_stiffness()
  bool at_link = false;  ///< k acts on q
};

/// k for the stiffness K asked, see above. `compliance` is 1 / K_J.
double law_stiffness(PositionFeedback position, double K, double compliance) noexcept;

struct ElasticDamping {
  double D = 0.0;
  double ratio = 0.0;  ///< of the slow pair of roots with it
};

/// The smallest D up to `most` with which the slow pair has the damping ratio asked, or that with
/// the greatest ratio. The pair is followed by Newton steps from D = 0 on. `rigid`, the design for
/// M + B as one, is what is left where the spring is so soft against the law that no D makes much
/// of a difference: between 0.3 and 0.15 of the ratio asked the one goes over into the other. Never
/// less than twice what the delay takes from the motor, k t_d. Of ratios above 0.75 that of 0.75 in
/// proportion. D is continuous in all arguments but where the pair meets that of the spring: on a
/// rotor as heavy as the link it may change by a fifth at ratios of 0.5 to 0.7 and by half above,
/// on one of 0.4 of the link by two fifths from 0.9 on. t_d in s, 0 or more; `most` and `rigid` 0
/// or more. A bounded number of operations; may be called in the cycle.
ElasticDamping elastic_damping(const ElasticMode& mode, double ratio, double rigid, double most,
                               double t_d) noexcept;

/// Of the motor swinging between law and spring, the link at rest: k over the greatest that is
/// stable with this D. The motor's root on the imaginary axis, with x = w t_d,
///   B w^2 = K_J + k cos x + D w sin x,   k sin x = w (D_J + D cos x).
/// 1 or more, or infinite: unstable. With the law at the link, which does not move then, w is that
/// of K_J and D alone.
double motor_share(const ElasticMode& mode, double D, double t_d) noexcept;

}  // namespace limber::controller
#pragma GCC visibility pop
