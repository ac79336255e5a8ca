// Keeps a torque and its rate of change within what a joint allows.
#pragma once

#include "common/types.h"

namespace limber::controller {

/// Of the largest change a cycle that the driver's gate allows.
inline constexpr double kShareOfGateStep = 0.8;
/// Likewise, counted from what the drives apply. The rest is for drives that round their torque.
inline constexpr double kShareFromApplied = 0.9;

/// In this order: |tau| <= torque; |tau - previous| <= rate T, counted from the torque sent before.
/// A sine of amplitude a and angular frequency w passes unchanged while a <= rate T / (2 sin(w T /
/// 2)); far above, a triangle of amplitude rate / (4 f) is left of it. All members may be called in
/// the cycle.
class TorqueLimiter {
 public:
  struct Acted {
    bool torque = false;
    bool rate = false;
  };

  /// Both n, not negative: N m and N m/s.
  TorqueLimiter(const VectorJ& torque, const VectorJ& rate)
      : torque_(torque), rate_(rate), previous_(VectorJ::Zero(torque.size())) {}

  /// The torque the next step is counted from, as it is.
  void set_previous(const VectorJ& tau) noexcept { previous_ = tau; }
  const VectorJ& previous() const noexcept { return previous_; }
  const VectorJ& torque() const noexcept { return torque_; }

  /// What limit() lets through, n each, N m.
  struct Reach {
    VectorJ low;
    VectorJ high;
  };
  Reach reach(double T) const noexcept {
    return {(previous_ - T * rate_).cwiseMax(-torque_).cwiseMin(torque_),
            (previous_ + T * rate_).cwiseMax(-torque_).cwiseMin(torque_)};
  }

  /// Limits `tau`, T seconds after the torque before, and makes it the previous one. A joint whose
  /// torque is not a number keeps the previous one.
  Acted limit(double T, VectorJ* tau) noexcept;

 private:
  VectorJ torque_;
  VectorJ rate_;
  VectorJ previous_;
};

}  // namespace limber::controller
