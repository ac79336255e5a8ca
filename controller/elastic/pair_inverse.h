// What two motors have to do for a torque and a stiffness.
#pragma once

#include "controller/elastic/spring_law.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// x with pair.torque(c, x) = tau, rad; at most kFarthest_rad. Quadratic springs that
/// are taut: tau / (2 k2 c). May be called in the cycle.
double pair_deflection(const SpringPair& pair, double c, double tau) noexcept;

/// Least preload at which both springs stay taut under tau, rad: pull(2 c) = |tau|; quadratic
/// springs: sqrt(|tau| / (2 k2)), where their stiffness is sqrt(2 k2 |tau|). In the cycle.
double least_preload(const SpringPair& pair, double tau) noexcept;

/// Preload within least_preload() and `c_max` at which the pair carries tau with the stiffness
/// sigma, or comes nearest to it; quadratic springs: sigma / (2 k2). Stiffness has to grow with
/// preload, or not change. In the cycle.
double pair_preload(const SpringPair& pair, double sigma, double tau, double c_max) noexcept;

}  // namespace limber::controller
#pragma GCC visibility pop
