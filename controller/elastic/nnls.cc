#include "controller/elastic/nnls.h"

#include <Eigen/Cholesky>
#include <array>

namespace limber::controller {
namespace {

constexpr double kGradientRounding = 1e-12;

using Passive = std::array<bool, kMaxJoints>;  // may be positive; the others are held at zero

// The unconstrained solution in the passive coefficients, zero in the others.
VectorJ solve_passive(const MatrixJ& G, const VectorJ& h, const Passive& passive) noexcept {
  MatrixJ A = G;
  VectorJ b = h;
  for (Eigen::Index i = 0; i < h.size(); ++i) {
    if (passive[static_cast<std::size_t>(i)]) continue;
    A.row(i).setZero();
    A.col(i).setZero();
    A(i, i) = 1.0;
    b[i] = 0.0;
  }
  return A.ldlt().solve(b);
}

// Moves x towards z until the first coefficient reaches zero, and holds that one there.
void step_back(const VectorJ& z, VectorJ* x, Passive* passive) noexcept {
  double alpha = 1.0;
  Eigen::Index first = 0;
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    if (!(z[i] < 0.0)) continue;
    const double reach = (*x)[i] / ((*x)[i] - z[i]);
    if (reach > alpha) continue;
    alpha = reach;
    first = i;
  }
  *x = (*x + alpha * (z - *x)).cwiseMax(0.0);
  (*x)[first] = 0.0;
  (*passive)[static_cast<std::size_t>(first)] = false;
}

// The held coefficient whose growth lowers the cost most; -1: none does.
Eigen::Index best_to_free(const VectorJ& slope, const VectorJ& h, const Passive& passive) noexcept {
  Eigen::Index best = -1;
  double steepest = kGradientRounding * h.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < slope.size(); ++i) {
    if (passive[static_cast<std::size_t>(i)] || !(slope[i] > steepest)) continue;
    steepest = slope[i];
    best = i;
  }
  return best;
}

}  // namespace

VectorJ nonnegative_least_squares(const MatrixJ& G, const VectorJ& h) noexcept {
  const Eigen::Index n = h.size();
  VectorJ x = VectorJ::Zero(n);
  Passive passive{};
  for (Eigen::Index exchange = 0; exchange < 3 * n; ++exchange) {
    const Eigen::Index next = best_to_free(h - G * x, h, passive);
    if (next < 0) break;
    passive[static_cast<std::size_t>(next)] = true;
    VectorJ z = solve_passive(G, h, passive);
    while ((z.array() < 0.0).any()) {
      step_back(z, &x, &passive);
      z = solve_passive(G, h, passive);
    }
    x = z;
  }
  return x;
}

}  // namespace limber::controller
