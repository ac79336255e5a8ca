#include "sim/joints/spring.h"

#include <cmath>

namespace limber::sim {

double Spring::torque(double d) const noexcept {
  if (d < 0.0) return pull_only_ ? 0.0 : -torque(-d);
  const SpringConfig& c = config_;
  switch (c.law) {
    case SpringLaw::kQuadratic:
      return 0.5 * c.k2_Nm_per_rad2 * d * d;
    case SpringLaw::kCubic:
      return (c.stiffness_Nm_per_rad + c.k3_Nm_per_rad3 * d * d) * d;
    case SpringLaw::kExponential:
      return c.force_Nm * std::expm1(c.rate_per_rad * d);
    case SpringLaw::kSinh:
      return c.force_Nm * std::sinh(c.rate_per_rad * d);
    case SpringLaw::kLinear:
      break;
  }
  return c.stiffness_Nm_per_rad * d;
}

double Spring::stiffness(double d) const noexcept {
  if (d < 0.0) return pull_only_ ? 0.0 : stiffness(-d);
  const SpringConfig& c = config_;
  switch (c.law) {
    case SpringLaw::kQuadratic:
      return c.k2_Nm_per_rad2 * d;
    case SpringLaw::kCubic:
      return c.stiffness_Nm_per_rad + 3.0 * c.k3_Nm_per_rad3 * d * d;
    case SpringLaw::kExponential:
      return c.force_Nm * c.rate_per_rad * std::exp(c.rate_per_rad * d);
    case SpringLaw::kSinh:
      return c.force_Nm * c.rate_per_rad * std::cosh(c.rate_per_rad * d);
    case SpringLaw::kLinear:
      break;
  }
  return c.stiffness_Nm_per_rad;
}

double Spring::energy(double d) const noexcept {
  if (d < 0.0) return pull_only_ ? 0.0 : energy(-d);
  const SpringConfig& c = config_;
  switch (c.law) {
    case SpringLaw::kQuadratic:
      return c.k2_Nm_per_rad2 * d * d * d / 6.0;
    case SpringLaw::kCubic:
      return (0.5 * c.stiffness_Nm_per_rad + 0.25 * c.k3_Nm_per_rad3 * d * d) * d * d;
    case SpringLaw::kExponential:
      return c.force_Nm * (std::expm1(c.rate_per_rad * d) / c.rate_per_rad - d);
    case SpringLaw::kSinh:
      return c.force_Nm * (std::cosh(c.rate_per_rad * d) - 1.0) / c.rate_per_rad;
    case SpringLaw::kLinear:
      break;
  }
  return 0.5 * c.stiffness_Nm_per_rad * d * d;
}

}  // namespace limber::sim
