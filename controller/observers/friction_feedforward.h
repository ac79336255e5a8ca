// Torque that carries a joint over the friction its motion will meet.
#pragma once

#include <algorithm>

#include "common/types.h"

namespace limber::controller {

/// tau = share (F_c s(v_d) + d v),  s(v_d) = v_d / v_fade within +-v_fade, the sign beyond.
/// Coulomb friction goes by the desired velocity, which has no noise; viscous friction by the
/// measured one. Undercompensate: a share of 1 or more makes a stuck joint hunt; 0.7 to 0.9 is
/// usual. F_c: N m; d: N m s/rad; v_fade > 0: rad/s. May be called in the cycle.
struct FrictionFeedforward {
  VectorJ F_c;
  VectorJ d;
  double share;
  double v_fade;

  VectorJ torque(const VectorJ& v_d, const VectorJ& v) const noexcept {
    const VectorJ sign = (v_d / v_fade).cwiseMax(-1.0).cwiseMin(1.0);
    return share * (F_c.cwiseProduct(sign) + d.cwiseProduct(v));
  }
};

}  // namespace limber::controller
