// Torque of a joint's springs.
#pragma once

#include <algorithm>
#include <cmath>

#include "robots/loader/joint_chain.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// f(d), N m, odd in the deflection d, see SpringLaw. May be called in the cycle.
inline double spring_torque(const SpringConfig& spring, double d) noexcept {
  const double size = std::abs(d);
  switch (spring.law) {
    case SpringLaw::kLinear:
      return spring.stiffness_Nm_per_rad * d;
    case SpringLaw::kQuadratic:
      return 0.5 * spring.k2_Nm_per_rad2 * size * d;
    case SpringLaw::kCubic:
      return (spring.stiffness_Nm_per_rad + spring.k3_Nm_per_rad3 * d * d) * d;
    case SpringLaw::kExponential:
      return std::copysign(spring.force_Nm * std::expm1(spring.rate_per_rad * size), d);
    case SpringLaw::kSinh:
      return spring.force_Nm * std::sinh(spring.rate_per_rad * d);
  }
  return 0.0;
}

/// df/dd, N m/rad. May be called in the cycle.
inline double spring_stiffness(const SpringConfig& spring, double d) noexcept {
  const double size = std::abs(d);
  switch (spring.law) {
    case SpringLaw::kLinear:
      return spring.stiffness_Nm_per_rad;
    case SpringLaw::kQuadratic:
      return spring.k2_Nm_per_rad2 * size;
    case SpringLaw::kCubic:
      return spring.stiffness_Nm_per_rad + 3.0 * spring.k3_Nm_per_rad3 * d * d;
    case SpringLaw::kExponential:
      return spring.force_Nm * spring.rate_per_rad * std::exp(spring.rate_per_rad * size);
    case SpringLaw::kSinh:
      return spring.force_Nm * spring.rate_per_rad * std::cosh(spring.rate_per_rad * d);
  }
  return 0.0;
}

/// d with f(d) = tau, rad. May be called in the cycle.
inline double spring_deflection(const SpringConfig& spring, double tau) noexcept {
  const double size = std::abs(tau);
  const double K = spring.stiffness_Nm_per_rad, k3 = spring.k3_Nm_per_rad3;
  switch (spring.law) {
    case SpringLaw::kLinear:
      return tau / K;
    case SpringLaw::kQuadratic:
      return std::copysign(std::sqrt(2.0 * size / spring.k2_Nm_per_rad2), tau);
    case SpringLaw::kCubic: {
      // d = 2 r sinh(z), as 4 sinh(z)^3 + 3 sinh(z) = sinh(3 z).
      if (!(k3 > 0.0)) return tau / K;
      const double r = std::sqrt(K / (3.0 * k3));
      return 2.0 * r * std::sinh(std::asinh(1.5 * tau / (K * r)) / 3.0);
    }
    case SpringLaw::kExponential:
      return std::copysign(std::log1p(size / spring.force_Nm) / spring.rate_per_rad, tau);
    case SpringLaw::kSinh:
      return std::asinh(tau / spring.force_Nm) / spring.rate_per_rad;
  }
  return 0.0;
}

/// Two springs that pull against each other: c is the preload, x the equilibrium's distance from
/// the link, so that they are stretched by c + x and c - x. A pull-only law is slack below zero.
/// For quadratic springs that are taut tau = 2 k2 c x and sigma = 2 k2 c. May be called in the
/// cycle.
struct SpringPair {
  SpringConfig spring;

  double stretch(double d) const noexcept {
    const bool pulls_only =
        spring.law == SpringLaw::kQuadratic || spring.law == SpringLaw::kExponential;
    return pulls_only ? std::max(d, 0.0) : d;
  }
  double pull(double d) const noexcept { return spring_torque(spring, stretch(d)); }
  /// On the link, N m.
  double torque(double c, double x) const noexcept { return pull(c + x) - pull(c - x); }
  /// Against winding up the preload, N m: what tau_1 + tau_2 has to hold.
  double preload_torque(double c, double x) const noexcept { return pull(c + x) + pull(c - x); }
  /// d pull / d d, N m/rad.
  double slope(double d) const noexcept {
    return stretch(d) == d ? spring_stiffness(spring, d) : 0.0;
  }
  /// d tau / d x, N m/rad.
  double stiffness(double c, double x) const noexcept { return slope(c + x) + slope(c - x); }
};

}  // namespace limber::controller
#pragma GCC visibility pop
