// Where springs are in the joints: a law that the rate limit holds back for long lets go.
#pragma once

#include <algorithm>

#include "common/types.h"

namespace limber::controller {

/// Torque that lags behind what a law demands, since its rate is limited, swings springs up instead
/// of damping them: a limit cycle, as of an aircraft with slow rudders. While more than half of the
/// last kMemory_s was limited, what exceeds the weight fades, and comes back afterwards; the walls,
/// too, which are springs (Stopping still stops the arm at its ends):
///
///   kMemory_s m' = (1 if the rate limit acted, else 0) - m
///   share' = -1 / kFades_s if m > 1/2, else 1 / kReturns_s;   0 <= share <= 1
///   tau = g + share (tau - g)
///
/// A single step takes torque limit over rate limit; share falls below 1 where that is more than
/// ln 2 kMemory_s. All members may be called in the cycle.
class RateRelief {
 public:
  static constexpr double kMemory_s = 0.03;
  static constexpr double kFades_s = 0.05;
  static constexpr double kReturns_s = 0.5;

  /// True if it acts. `g`: torque that carries the weight, n, N m.
  bool apply(const VectorJ& g, VectorJ* tau) const noexcept {
    if (!(share_ < 1.0)) return false;
    *tau = g + share_ * (*tau - g);
    return true;
  }
  /// After the rate limit, once a cycle.
  void note(bool limited, double period_s) noexcept {
    limited_ += ((limited ? 1.0 : 0.0) - limited_) * std::min(period_s / kMemory_s, 1.0);
    const double rate = limited_ > 0.5 ? -1.0 / kFades_s : 1.0 / kReturns_s;
    share_ = std::clamp(share_ + period_s * rate, 0.0, 1.0);
  }
  void reset() noexcept { *this = RateRelief(); }

  double share() const noexcept { return share_; }

 private:
  double limited_ = 0.0;  // m
  double share_ = 1.0;
};

}  // namespace limber::controller
