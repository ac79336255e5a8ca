// All functions of a level, for arms of each size: included by its source file alone.
#pragma once

#include <type_traits>

#include "dynamics/levels.h"
#include "dynamics/row_geometric_mean.h"
#include "dynamics/row_kernel.h"
#include "dynamics/row_spd_solve.h"

namespace limber::dynamics::LIMBER_LEVEL {

/// `call` with the least number of lanes that has room for n joints.
template <typename Call>
auto with_room(Eigen::Index n, const Call& call) {
  if (n <= 2) return call(std::integral_constant<int, 2>());
  if (n <= 4) return call(std::integral_constant<int, 4>());
  if (n <= 8) return call(std::integral_constant<int, 8>());
  if (n <= 12) return call(std::integral_constant<int, 12>());
  return call(std::integral_constant<int, kMaxJoints>());
}

#define LIMBER_NAME_OF(level) #level
#define LIMBER_NAME(level) LIMBER_NAME_OF(level)

extern const Level kLevel;
const Level kLevel = {
    .name = LIMBER_NAME(LIMBER_LEVEL),
    .arm_kernel =
        [](const BodyChain& chain, const Eigen::Vector3d& gravity) {
          return with_room(chain.size(), [&](auto N) -> std::unique_ptr<ArmKernel> {
            return std::make_unique<RowKernel<N()>>(chain, gravity);
          });
        },
    .solve_one =
        [](const MatrixJ& M, VectorJ* X) noexcept {
          with_room(M.rows(), [&](auto N) { solve_one<N()>(M, X); });
        },
    .solve_tip =
        [](const MatrixJ& M, const Matrix6J& J, MatrixJ6* X, Matrix6* G) noexcept {
          with_room(M.rows(), [&](auto N) { solve_tip<N()>(M, J, X, G); });
        },
    .inverse = [](const Matrix6& G) noexcept { return inverse(G); },
    .mean =
        [](const Eigen::Ref<const Eigen::MatrixXd>& P, const Eigen::Ref<const Eigen::MatrixXd>& Q,
           Eigen::Ref<Eigen::MatrixXd> G) noexcept {
          return with_room(P.rows(), [&](auto N) { return mean<N()>(P, Q, G); });
        },
};

}  // namespace limber::dynamics::LIMBER_LEVEL
