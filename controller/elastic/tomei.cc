#include "controller/elastic/tomei.h"

#include <Eigen/Eigenvalues>
#include <limits>

namespace limber::controller {

double Tomei::lambda_min() const noexcept {
  const Eigen::Index n = K_J.size();
  using Both = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                             2 * kMaxJoints, 2 * kMaxJoints>;
  const MatrixJ springs = K_J.asDiagonal();
  Both stiffness(2 * n, 2 * n);
  stiffness.topLeftCorner(n, n) = springs;
  stiffness.topRightCorner(n, n) = -springs;
  stiffness.bottomLeftCorner(n, n) = -springs;
  stiffness.bottomRightCorner(n, n) = springs + 0.5 * (K_P + K_P.transpose());
  return Eigen::SelfAdjointEigenSolver<Both>(stiffness, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

double critical_motor_gain(double K_J, double alpha) noexcept {
  return alpha < K_J ? alpha * K_J / (K_J - alpha) : std::numeric_limits<double>::infinity();
}

}  // namespace limber::controller
