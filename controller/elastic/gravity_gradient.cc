#include "controller/elastic/gravity_gradient.h"

namespace limber::controller {
namespace {

constexpr double kGradientStep = 1e-5;  // rad or m

}  // namespace

MatrixJ gravity_gradient(ArmModel* model, const VectorJ& q) noexcept {
  const Eigen::Index n = q.size();
  MatrixJ gradient(n, n);
  VectorJ at = q;
  for (Eigen::Index i = 0; i < n; ++i) {
    at[i] = q[i] + kGradientStep;
    const VectorJ ahead = model->gravity(at);
    at[i] = q[i] - kGradientStep;
    const VectorJ behind = model->gravity(at);
    at[i] = q[i];
    gradient.col(i) = (ahead - behind) / (2.0 * kGradientStep);
  }
  return 0.5 * (gradient + gradient.transpose());
}

}  // namespace limber::controller
