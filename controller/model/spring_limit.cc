#include "controller/model/spring_limit.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace limber::controller {
namespace {

// |K_pp e_p| <= sqrt(2 U lambda_max(K_pp)): the energy at which a force is first possible.
double energy_at(double force, const Eigen::Matrix3d& K) noexcept {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(K, Eigen::EigenvaluesOnly);
  const double stiffest = eigen.eigenvalues()[2];
  return stiffest > 0.0 ? force * force / (2.0 * stiffest)
                        : std::numeric_limits<double>::infinity();
}

}  // namespace

SpringLimit::SpringLimit(const Matrix6& K, double force_N, double moment_Nm) noexcept
    : U_max_(std::min(energy_at(force_N, K.topLeftCorner<3, 3>()),
                      energy_at(moment_Nm, K.bottomRightCorner<3, 3>()))) {}

LimitedSpring SpringLimit::apply(double U) const noexcept {
  if (!(U > U_max_)) return {1.0, U};
  return {std::sqrt(U_max_ / U), 2.0 * std::sqrt(U * U_max_) - U_max_};
}

}  // namespace limber::controller
