// The damping a user's gains ask for: a design, or the matrix given.
//
// M with rotors also where a spring lies between motor and link, for laws that know no springs. A
// link M on K_J, the motor held by K_m with the damper D, loses most where w D = sqrt(K_m (K_m +
// K_J)); more damping than this would hold the motor and leave the link to its spring. For laws
// that tell of their springs, elastic_damping.h finds it.
#pragma once

#include "controller/elastic/joint_elasticity.h"
#include "controller/kinds/gains.h"
#include "controller/model/arm_terms.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// For the joint stiffness K_q on the inertia M (n x n), with the floor for joints without
/// stiffness unless it is given. In the cycle.
MatrixJ chosen_joint_damping(const Gains& gains, const MatrixJ& M, const MatrixJ& K_q) noexcept;

/// The same for an inertia and a stiffness that seldom change: designed anew when one of them, or a
/// gain, is another than in the last call.
class KeptJointDamping {
 public:
  explicit KeptJointDamping(int joints);
  /// In the cycle.
  const MatrixJ& of(const Gains& gains, const MatrixJ& M, const MatrixJ& K_q) noexcept;

 private:
  DampingDesign design_ = DampingDesign::kGiven;
  double ratio_ = -1.0;
  MatrixJ M_;
  MatrixJ K_q_;
  MatrixJ D_;
};

/// The same for a law that moves its links through springs: the double diagonalisation reckons with
/// them (elastic_design.h). `elastic` nullptr: rigid joints. In the cycle.
MatrixJ chosen_joint_damping(const Gains& gains, const ArmTerms& terms, const MatrixJ& K_q,
                             const JointElasticity* elastic) noexcept;

/// For K_x at the tip, without the floor. In the cycle.
Matrix6 chosen_tip_damping(const Gains& gains, const ArmTerms& terms,
                           const JointElasticity* elastic = nullptr) noexcept;

}  // namespace limber::controller
#pragma GCC visibility pop
