#include "controller/elastic/vsa_stiffness.h"

#include <Eigen/LU>

#include "controller/elastic/nnls.h"

namespace limber::controller {

JointFit nearest_joint_stiffness(const TaskJacobian& J, const TaskMatrix& K_x,
                                 const MatrixJ& K_G) noexcept {
  MatrixJ K_q = J.transpose() * K_x * J + K_G;
  const VectorJ diagonal = K_q.diagonal();
  const double all = K_q.norm();
  K_q.diagonal().setZero();
  return {diagonal, all > 0.0 ? K_q.norm() / all : 0.0};
}

// With j_i the columns of W J and C = W K_x^-1 W, the normal equations of sum s_i j_i j_i^T = C are
// G_ik = (j_i . j_k)^2 and h_i = j_i^T C j_i.
JointFit nearest_joint_compliance(const TaskJacobian& J, const TaskMatrix& K_x) noexcept {
  const auto W = K_x.diagonal().cwiseSqrt().asDiagonal();
  const TaskJacobian WJ = W * J;
  const TaskMatrix C = W * K_x.inverse() * W;
  const MatrixJ products = WJ.transpose() * WJ;
  const MatrixJ G = products.cwiseAbs2();
  const VectorJ h = (WJ.transpose() * C * WJ).diagonal();
  const VectorJ s = nonnegative_least_squares(G, h);
  const TaskMatrix missed = WJ * s.asDiagonal() * WJ.transpose() - C;
  return {s, missed.norm() / C.norm()};
}

TaskMatrix presented_compliance(const TaskJacobian& J, const VectorJ& sigma,
                                const MatrixJ& K_G) noexcept {
  MatrixJ K = -K_G;
  K.diagonal() += sigma;
  const MatrixJ inverse = K.inverse();
  return J * inverse * J.transpose();
}

}  // namespace limber::controller
