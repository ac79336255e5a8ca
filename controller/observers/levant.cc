#include "controller/observers/levant.h"

#include <cmath>

#include "controller/model/positive.h"

namespace limber::controller {

LevantDifferentiator::LevantDifferentiator(int joints, double L, double T)
    : L_(positive(L, "the bound of the acceleration")),
      T_(positive(T, "the sample time")),
      z0_(VectorJ::Zero(joints)),
      z1_(VectorJ::Zero(joints)) {}

void LevantDifferentiator::reset() noexcept {
  started_ = false;
  z1_.setZero();
}

void LevantDifferentiator::start(const VectorJ& x, const VectorJ& v) noexcept {
  z0_ = x;
  z1_ = v;
  started_ = true;
}

const VectorJ& LevantDifferentiator::update(const VectorJ& x) noexcept {
  if (!x.allFinite()) return z1_;
  if (!started_) {
    z0_ = x;
    started_ = true;
    return z1_;
  }
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double error = z0_[i] - x[i];
    const double sign = error > 0.0 ? 1.0 : (error < 0.0 ? -1.0 : 0.0);
    z0_[i] += T_ * (-1.5 * std::sqrt(L_ * std::abs(error)) * sign + z1_[i]);
    z1_[i] += T_ * (-1.1 * L_ * sign);
  }
  return z1_;
}

}  // namespace limber::controller
