// Bounds the force of a Cartesian spring without making it non-conservative.
#pragma once

#include "common/types.h"

#pragma GCC visibility push(default)
namespace limber::controller {

struct LimitedSpring {
  double scale;     ///< h: the spring's wrench is -h A^T K e
  double energy_J;  ///< the potential whose gradient that is
};

/// From the stored energy U = e^T K e / 2 on where the wrench could first exceed `force_N` or
/// `moment_Nm`, the spring's potential grows with the square root of U instead:
///   H = U                     for U <= U_max
///   H = 2 sqrt(U U_max) - U_max  above;       h = dH/dU = sqrt(U_max / U).
/// H is a function of U alone, so the limited spring still has a potential, whatever K is. With
/// equal stiffness in all directions this holds the force at its maximum; a softer direction stays
/// softer. The moment may reach pi / 2 times its bound where A turns it.
class SpringLimit {
 public:
  SpringLimit(const Matrix6& K, double force_N, double moment_Nm) noexcept;
  /// `U` in J. May be called in the cycle.
  LimitedSpring apply(double U) const noexcept;

 private:
  double U_max_;
};

}  // namespace limber::controller
#pragma GCC visibility pop
