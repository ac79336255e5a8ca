// Damping for joints or tip of an arm with springs in its joints, mode by mode.
//
// The modes u are those of the design for rigid joints, u^T (M + B) u = 1 and u^T K u = w^2 (see
// damping_design.h). Each is taken as a joint of its own (elastic_damping.h): a force w^2 along it
// is the joint torque p = (M + B) u, which bends the springs by K_J^-1 p. So
//   rotor u^T B u, link 1 - u^T B u, 1 / spring p^T K_J^-1 p,
//   damper / spring^2  p^T K_J^-1 D_J K_J^-1 p
// and D = sum of d p p^T. That is exact where M, B, K_J and K have their modes in common, as those
// of one joint do.
//
// At no motor D may take more than half of what is stable: sampled at T and a cycle late, a rotor
// under its own damper is stable for D < B / T.
#pragma once

#include <array>
#include <cstddef>

#include "common/types.h"
#include "controller/elastic/joint_elasticity.h"
#include "controller/kinds/gains.h"
#include "controller/model/arm_terms.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// A mode with less stiffness, as a share of the stiffest one's, has none.
inline constexpr double kNoStiffness = 1e-9;

/// What became of each mode, softest first; those without stiffness are left out.
struct ElasticDesign {
  struct Mode {
    double frequency_rad_per_s = 0.0;  ///< w
    double ratio = 0.0;                ///< of its slow pair of roots
    double motor_share = 0.0;          ///< see elastic_damping.h
  };
  std::array<Mode, kMaxJoints> modes{};
  std::size_t count = 0;

  /// Infinity without a mode.
  double least_ratio() const noexcept;
};

/// n x n, N m s/rad, for the stiffness K (n x n) that a law with this position asks for. `terms`:
/// inertia. May be called in the cycle.
MatrixJ elastic_joint_damping(const JointElasticity& joints, const ArmTerms& terms,
                              const MatrixJ& K, double ratio,
                              ElasticDesign* design = nullptr) noexcept;

/// 6 x 6 for K (6 x 6) at the tip. `terms`: inertia and Jacobian. Directions out of reach get none.
/// May be called in the cycle.
Matrix6 elastic_tip_damping(const JointElasticity& joints, const ArmTerms& terms, const Matrix6& K,
                            double ratio, ElasticDesign* design = nullptr) noexcept;

/// What comes of the modes with these gains. May be called in the cycle.
ElasticDesign joint_design(const JointElasticity& joints, const ArmTerms& terms,
                           const Gains& gains) noexcept;
ElasticDesign tip_design(const JointElasticity& joints, const ArmTerms& terms,
                         const Gains& gains) noexcept;

/// Only the double diagonalisation is designed for springs. `elastic` nullptr: there are none.
inline bool reckons_with(const JointElasticity* elastic, DampingDesign design) noexcept {
  return elastic != nullptr && design == DampingDesign::kDoubleDiagonalisation;
}

}  // namespace limber::controller
#pragma GCC visibility pop
