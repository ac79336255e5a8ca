#include "controller/output/torque_limiter.h"

#include <algorithm>
#include <cmath>

namespace limber::controller {

TorqueLimiter::Acted TorqueLimiter::limit(double T, VectorJ* tau) noexcept {
  Acted acted;
  for (Eigen::Index i = 0; i < tau->size(); ++i) {
    const double wanted = std::isnan((*tau)[i]) ? previous_[i] : (*tau)[i];
    const double saturated = std::clamp(wanted, -torque_[i], torque_[i]);
    const double step = rate_[i] * T;
    const double limited = std::clamp(saturated, previous_[i] - step, previous_[i] + step);
    acted.torque |= saturated != wanted;
    acted.rate |= limited != saturated;
    (*tau)[i] = limited;
  }
  previous_ = *tau;
  return acted;
}

}  // namespace limber::controller
