#include "controller/observers/friction_observer.h"

#include "controller/model/positive.h"

namespace limber::controller {

FrictionObserver::FrictionObserver(const VectorJ& B, const VectorJ& L, double T)
    : LB_(L.cwiseProduct(B)),
      TL_(positive(T, "the sample time") * L),
      z_(VectorJ::Zero(B.size())),
      tau_f_(VectorJ::Zero(B.size())) {
  for (const double inertia : B) positive(inertia, "the rotor inertia of a friction observer");
  for (const double gain : L) {
    if (positive(gain, "the gain of a friction observer") * T >= 2.0) {
      throw ConfigError("a friction observer with gain " + std::to_string(gain) +
                        " rad/s needs a sample time below " + std::to_string(2.0 / gain) + " s");
    }
  }
}

void FrictionObserver::reset() noexcept {
  started_ = false;
  tau_f_.setZero();
}

const VectorJ& FrictionObserver::update(const VectorJ& theta_dot, const VectorJ& tau_m,
                                        const VectorJ& tau_t) noexcept {
  if (!theta_dot.allFinite() || !tau_m.allFinite() || !tau_t.allFinite()) return tau_f_;
  const VectorJ momentum = LB_.cwiseProduct(theta_dot);
  if (!started_) z_ = momentum;
  started_ = true;
  tau_f_ = z_ - momentum;
  z_ += TL_.cwiseProduct(tau_m - tau_t - tau_f_);
  return tau_f_;
}

}  // namespace limber::controller
