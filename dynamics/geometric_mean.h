// The geometric mean of two symmetric positive matrices.
#pragma once

#include <Eigen/Core>

#pragma GCC visibility push(default)
namespace limber::dynamics {

/// P # Q = P (P^-1 Q)^1/2, the one G, symmetric and positive, with G P^-1 G = Q: in axes in which P
/// and Q are diagonal, the root of each product (Pusz, Woronowicz 1975). P, Q, G: n x n,
/// n up to kMaxJoints; of P and Q the lower half counts; G may not be P or Q.
///   A, B <- (A + B) / 2, 2 (A^-1 + B^-1)^-1 = 2 A (A + B)^-1 B      from P and Q
/// both tend to the mean, and differ by the square of what they differed by before. Scaling A by
/// 1 / c and B by c, which leaves the mean as it is, spares the first steps: five in all where the
/// eigenvalues of P^-1 Q span three decades.
/// Where Q is singular, Q = F F^T with fewer columns than rows, the mean is what it tends to:
///   G = F (F^T P^-1 F)^(-1/2) F^T
/// Returns false, with G of no meaning, where P is singular, Q has a negative eigenvalue, or either
/// is not finite or too close to such. In the cycle.
[[nodiscard]] bool geometric_mean(const Eigen::Ref<const Eigen::MatrixXd>& P,
                                  const Eigen::Ref<const Eigen::MatrixXd>& Q,
                                  Eigen::Ref<Eigen::MatrixXd> G) noexcept;

}  // namespace limber::dynamics
#pragma GCC visibility pop
