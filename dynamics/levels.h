// The kinds of processor that the rows of joints are compiled for, and what is chosen among them.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string_view>
#include <vector>

#include "common/types.h"
#include "dynamics/arm_kernel.h"

namespace limber::dynamics {

/// The functions of arm_kernel.h, spd_solve.h and geometric_mean.h for one kind of processor.
struct Level {
  const char* name;
  std::unique_ptr<ArmKernel> (*arm_kernel)(const BodyChain& chain, const Eigen::Vector3d& gravity);
  void (*solve_one)(const MatrixJ& M, VectorJ* X) noexcept;
  void (*solve_tip)(const MatrixJ& M, const Matrix6J& J, MatrixJ6* X, Matrix6* G) noexcept;
  Matrix6 (*inverse)(const Matrix6& G) noexcept;
  bool (*mean)(const Eigen::Ref<const Eigen::MatrixXd>& P,
               const Eigen::Ref<const Eigen::MatrixXd>& Q, Eigen::Ref<Eigen::MatrixXd> G) noexcept;
};

/// All that this processor can run, the fastest first; the last one runs on any.
std::vector<const Level*> levels();

/// Throws ConfigError where this processor cannot run what is named.
const Level& named_level(std::string_view name);

/// The first of them, or what $LIMBER_PROCESSOR names: chosen once, by the first kernel. Throws
/// likewise.
const Level& level();

}  // namespace limber::dynamics
