// Velocity from position, acceleration from velocity: the difference of samples behind one pole.
#pragma once

#include <cmath>

#include "common/types.h"
#include "controller/model/positive.h"

namespace limber::controller {

/// Corner for the rate of joint torques and spring deflections, which laws of elastic joints damp.
inline constexpr double kTorqueRateCorner_rad_per_s = 600.0;

/// v_k = a v_{k-1} + (1 - a) (x_k - x_{k-1}) / T,   a = exp(-w_c T)
/// (the difference is exact for the mean of the interval; Franklin, Powell, Workman: Digital
/// Control of Dynamic Systems). Noise of x with standard deviation s comes out as
/// s (1 - a) / T sqrt(2 / (1 + a)); the delay is a T / (1 - a) + T / 2. The first sample gives
/// zero. x in any unit u, v in u/s. A sample that is not finite is left out.
template <typename Vector>
class FilteredDifference {
 public:
  /// Corner w_c in rad/s, sample time T in s. Throws ConfigError unless both are positive.
  FilteredDifference(int size, double corner_rad_per_s, double T)
      : pole_(std::exp(-positive(corner_rad_per_s, "the corner of a velocity filter") *
                       positive(T, "the sample time"))),
        T_(T),
        x_(Vector::Zero(size)),
        v_(Vector::Zero(size)) {}

  /// Another corner for the estimate that goes on. May be called in the cycle.
  void set_corner(double corner_rad_per_s) noexcept { pole_ = std::exp(-corner_rad_per_s * T_); }

  /// The next sample is the first. May be called in the cycle.
  void reset() noexcept {
    started_ = false;
    v_.setZero();
  }

  /// The last sample was x, moving at v: an estimate that goes on. May be called in the cycle.
  void start(const Vector& x, const Vector& v) noexcept {
    x_ = x;
    v_ = v;
    started_ = true;
  }

  /// May be called in the cycle.
  const Vector& update(const Vector& x) noexcept {
    if (!x.allFinite()) return v_;
    if (started_) v_ = pole_ * v_ + (1.0 - pole_) / T_ * (x - x_);
    x_ = x;
    started_ = true;
    return v_;
  }

  const Vector& velocity() const noexcept { return v_; }
  double pole() const noexcept { return pole_; }

 private:
  double pole_;
  double T_;
  Vector x_;
  Vector v_;
  bool started_ = false;
};

/// Acceleration of the tip from its twist V_BT: base axes, linear part first, m/s^2 and rad/s^2.
using TipAcceleration = FilteredDifference<Vector6>;

}  // namespace limber::controller
