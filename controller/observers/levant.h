// Velocity by the robust exact differentiator: exact without noise, bounded error with it.
#pragma once

#include "common/types.h"

namespace limber::controller {

/// Levant 1998, first order, by explicit Euler steps (both with the same old z0):
///   z0' = -1.5 sqrt(L) |z0 - x|^(1/2) sign(z0 - x) + z1,   z1' = -1.1 L sign(z0 - x),
/// sign(0) = 0; the velocity is z1 after the step. L >= sup |x''|, rad/s^2. The error is of order
/// L T without noise and sqrt(L e) with noise bounded by e. The first sample sets z0 and gives
/// zero. A sample that is not finite is left out.
class LevantDifferentiator {
 public:
  /// L in rad/s^2, T in s. Throws ConfigError unless both are positive.
  LevantDifferentiator(int joints, double L, double T);

  /// The next sample is the first. May be called in the cycle.
  void reset() noexcept;
  /// The last sample was x, moving at v: an estimate that goes on. May be called in the cycle.
  void start(const VectorJ& x, const VectorJ& v) noexcept;
  /// x: measured position, n. Returns the velocity. May be called in the cycle.
  const VectorJ& update(const VectorJ& x) noexcept;

  const VectorJ& velocity() const noexcept { return z1_; }

 private:
  double L_;
  double T_;
  VectorJ z0_;
  VectorJ z1_;
  bool started_ = false;
};

}  // namespace limber::controller
