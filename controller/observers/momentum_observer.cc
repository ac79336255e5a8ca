#include "controller/observers/momentum_observer.h"

#include "controller/model/positive.h"

namespace limber::controller {

MomentumObserver::MomentumObserver(const VectorJ& K_O, double T)
    : K_O_(K_O),
      T_(positive(T, "the sample time")),
      acc_(VectorJ::Zero(K_O.size())),
      rate_(acc_),
      r_(acc_) {
  for (const double gain : K_O) {
    if (positive(gain, "the gain of a momentum observer") * T >= 2.0) {
      throw ConfigError("a momentum observer with gain " + std::to_string(gain) +
                        " rad/s needs a sample time below " + std::to_string(2.0 / gain) + " s");
    }
  }
}

void MomentumObserver::reset() noexcept {
  started_ = false;
  r_.setZero();
}

const VectorJ& MomentumObserver::update(const VectorJ& p, const VectorJ& tau,
                                        const VectorJ& beta) noexcept {
  if (!p.allFinite() || !tau.allFinite() || !beta.allFinite()) return r_;
  if (started_) {
    acc_ += T_ * rate_;
    r_ = K_O_.cwiseProduct(p - acc_);
  } else {
    acc_ = p;
  }
  rate_ = tau + beta + r_;
  started_ = true;
  return r_;
}

}  // namespace limber::controller
