#include "controller/observers/alpha_beta.h"

#include <cmath>

#include "controller/model/positive.h"

namespace limber::controller {

AlphaBetaGains::AlphaBetaGains(double s_a, double s_x, double T) {
  positive(s_a, "the standard deviation of the acceleration");
  positive(s_x, "the standard deviation of the position");
  const double lambda = s_a * positive(T, "the sample time") * T / s_x;
  const double r = (4.0 + lambda - std::sqrt(8.0 * lambda + lambda * lambda)) / 4.0;
  alpha = 1.0 - r * r;
  beta = 2.0 * (2.0 - alpha) - 4.0 * std::sqrt(1.0 - alpha);
}

AlphaBeta::AlphaBeta(int joints, const AlphaBetaGains& gains, double T)
    : gains_(gains),
      T_(positive(T, "the sample time")),
      x_(VectorJ::Zero(joints)),
      v_(VectorJ::Zero(joints)) {}

void AlphaBeta::reset() noexcept {
  started_ = false;
  v_.setZero();
}

void AlphaBeta::start(const VectorJ& x, const VectorJ& v) noexcept {
  x_ = x;
  v_ = v;
  started_ = true;
}

const VectorJ& AlphaBeta::update(const VectorJ& z) noexcept {
  const bool usable = z.allFinite();
  if (!started_) {
    if (usable) x_ = z;
    started_ = usable;
    return v_;
  }
  x_ += T_ * v_;
  if (!usable) return v_;
  const VectorJ innovation = z - x_;
  x_ += gains_.alpha * innovation;
  v_ += gains_.beta / T_ * innovation;
  return v_;
}

}  // namespace limber::controller
