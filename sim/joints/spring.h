// Torque of a spring over its deflection d, odd in d or slack for d < 0.
//
//   linear        k d                    quadratic  k2 d^2 / 2
//   cubic         k d + k3 d^3           exponential  F (exp(r d) - 1)
//   sinh          F sinh(r d)
//
// Sources: Migliore, Brown, DeWeerth, "Biologically inspired joint stiffness control", ICRA 2005
// (quadratic); Catalano et al., "VSA-CubeBot", ICRA 2011 (sinh); exponential as the tendons of
// Hagen et al., Frontiers in Neuroscience 2021.
//
// The controller has its own spring laws (controller/elastic/spring_law.h), on purpose: neither
// side inherits a mistake of the other, and a simulated run checks one against the other.
#pragma once

#include "robots/loader/joint_chain.h"

namespace limber::sim {

/// A value; every member is allowed in the cycle. d in rad (m), torque in N m (N).
class Spring {
 public:
  Spring() = default;
  Spring(const SpringConfig& config, bool pull_only) : config_(config), pull_only_(pull_only) {}

  double torque(double d) const noexcept;     ///< f(d)
  double stiffness(double d) const noexcept;  ///< f'(d)
  double energy(double d) const noexcept;     ///< integral of f from 0 to d, J
  bool pull_only() const noexcept { return pull_only_; }

 private:
  SpringConfig config_;
  bool pull_only_ = false;
};

}  // namespace limber::sim
