// Keeps the torque continuous when something about the law changes at once.
#pragma once

#include <cmath>
#include <numbers>

#include "common/types.h"

namespace limber::controller {

/// After a switch at t = 0:
///   tau = tau_law + offset (1 + cos(pi t / T)) / 2,   offset(0) = tau_before - tau_law(0).
/// The first torque equals the torque before the switch; from T on the law is alone. The law is in
/// force from the start, so a position that the torque before did not hold is held by its spring.
/// On a joint that moves the way the offset pushes, the offset also decays with kPushing_s: what is
/// left of the torque before shall not drive an arm that has become free.
/// All members may be called in the cycle.
class TorqueBlend {
 public:
  explicit TorqueBlend(int joints) : offset_(VectorJ::Zero(joints)) {}

  static constexpr double kDuration_s = 0.5;
  static constexpr double kPushing_s = 0.03;

  /// The next blended torque is `before`.
  void start(const VectorJ& before, const VectorJ& law) noexcept {
    offset_ = before - law;
    elapsed_s_ = 0.0;
  }
  void advance(double dt_s, const VectorJ& v) noexcept {
    if (!active()) return;
    elapsed_s_ += dt_s;
    for (Eigen::Index i = 0; i < v.size(); ++i) {
      if (offset_[i] * v[i] > 0.0) offset_[i] *= std::exp(-dt_s / kPushing_s);
    }
  }
  bool active() const noexcept { return elapsed_s_ < kDuration_s; }

  void add_to(VectorJ* tau) const noexcept {
    if (active()) {
      *tau += (0.5 + 0.5 * std::cos(std::numbers::pi * elapsed_s_ / kDuration_s)) * offset_;
    }
  }

 private:
  VectorJ offset_;
  double elapsed_s_ = kDuration_s;
};

}  // namespace limber::controller
