// Velocity by the steady-state Kalman filter of a randomly accelerated joint.
#pragma once

#include "common/types.h"

namespace limber::controller {

/// Gains of the alpha-beta tracker whose model is an acceleration that is constant over a sample
/// and random from one to the next (Kalata 1984):
///   lambda = s_a T^2 / s_x,  r = (4 + lambda - sqrt(8 lambda + lambda^2)) / 4,
///   alpha = 1 - r^2,  beta = 2 (2 - alpha) - 4 sqrt(1 - alpha).
struct AlphaBetaGains {
  /// s_a: standard deviation of the acceleration, rad/s^2; s_x: of the position's noise, rad; T in
  /// s. Throws ConfigError unless all are positive.
  AlphaBetaGains(double s_a, double s_x, double T);

  double alpha;
  double beta;
};

/// x- = x + T v,  e = z - x-,  x = x- + alpha e,  v = v + (beta / T) e. The first sample sets x and
/// gives v = 0. A sample that is not finite is replaced by its prediction.
class AlphaBeta {
 public:
  AlphaBeta(int joints, const AlphaBetaGains& gains, double T);

  /// The next sample is the first. May be called in the cycle.
  void reset() noexcept;
  /// The last sample was x, moving at v: an estimate that goes on. May be called in the cycle.
  void start(const VectorJ& x, const VectorJ& v) noexcept;
  /// z: measured position, n. Returns v. May be called in the cycle.
  const VectorJ& update(const VectorJ& z) noexcept;

  const VectorJ& position() const noexcept { return x_; }
  const VectorJ& velocity() const noexcept { return v_; }

 private:
  AlphaBetaGains gains_;
  double T_;
  VectorJ x_;
  VectorJ v_;
  bool started_ = false;
};

}  // namespace limber::controller
