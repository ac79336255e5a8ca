// One joint with two motors that pull against each other through quadratic springs, in closed form.
// The controller places its motors by pair_inverse.h, for springs of any law.
#pragma once

#include <algorithm>
#include <cmath>

namespace limber::eval {

/// Motor positions behind the gear, rad.
struct VsaMotors {
  double theta_1 = 0.0;
  double theta_2 = 0.0;
};

struct VsaJoint {
  double tau = 0.0;    ///< torque on the link, N m
  double sigma = 0.0;  ///< stiffness -d tau / d q, N m/rad
};

/// Tendons with the spring law f = k2 delta^2 / 2, delta_1 = theta_1 - q, delta_2 = theta_2 + q,
/// slack below zero (Migliore, Brown, DeWeerth 2005):
///   tau = f(delta_1) - f(delta_2),   sigma = k2 (delta_1 + delta_2).
/// k2 in N m/rad^2. May be called in the cycle.
inline VsaJoint vsa_forward(const VsaMotors& motors, double q, double k2) noexcept {
  const double first = std::max(motors.theta_1 - q, 0.0);
  const double second = std::max(motors.theta_2 + q, 0.0);
  return {0.5 * k2 * (first * first - second * second), k2 * (first + second)};
}

/// A pair can give sigma and tau with both tendons taut iff |tau| <= sigma^2 / (2 k2), sigma > 0.
inline bool vsa_feasible(const VsaJoint& wanted, double k2) noexcept {
  return wanted.sigma > 0.0 && std::abs(wanted.tau) <= wanted.sigma * wanted.sigma / (2.0 * k2);
}

/// theta_1 = c + e, theta_2 = c - e,  c = sigma / (2 k2),  e = q + tau / sigma. sigma > 0; gives
/// what is wanted only if vsa_feasible(). May be called in the cycle.
inline VsaMotors vsa_inverse(const VsaJoint& wanted, double q, double k2) noexcept {
  const double c = wanted.sigma / (2.0 * k2);
  const double e = q + wanted.tau / wanted.sigma;
  return {c + e, c - e};
}

}  // namespace limber::eval
