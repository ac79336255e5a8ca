#include "controller/impedance/chosen_damping.h"

#include "controller/impedance/damping_design.h"
#include "controller/impedance/elastic_design.h"

namespace limber::controller {

MatrixJ chosen_joint_damping(const Gains& gains, const MatrixJ& M, const MatrixJ& K_q) noexcept {
  const DampingDesign design = gains.settings.joint_damping;
  if (design == DampingDesign::kGiven) return gains.D_q;
  MatrixJ D = joint_damping(design, M, K_q, gains.joint_damping_ratio);
  D.diagonal() += joint_damping_floor(M, K_q);
  return D;
}

MatrixJ chosen_joint_damping(const Gains& gains, const ArmTerms& terms, const MatrixJ& K_q,
                             const JointElasticity* elastic) noexcept {
  if (!reckons_with(elastic, gains.settings.joint_damping)) {
    return chosen_joint_damping(gains, terms.M_total, K_q);
  }
  MatrixJ D = elastic_joint_damping(*elastic, terms, K_q, gains.joint_damping_ratio);
  D.diagonal() += joint_damping_floor(terms.M_total, K_q);
  return D;
}

KeptJointDamping::KeptJointDamping(int joints)
    : M_(MatrixJ::Zero(joints, joints)), K_q_(M_), D_(M_) {}

const MatrixJ& KeptJointDamping::of(const Gains& gains, const MatrixJ& M,
                                    const MatrixJ& K_q) noexcept {
  const DampingDesign design = gains.settings.joint_damping;
  if (design == DampingDesign::kGiven) {
    D_ = gains.D_q;
  } else if (design != design_ || gains.joint_damping_ratio != ratio_ || M != M_ || K_q != K_q_) {
    M_ = M;
    K_q_ = K_q;
    ratio_ = gains.joint_damping_ratio;
    D_ = chosen_joint_damping(gains, M, K_q);
  }
  design_ = design;
  return D_;
}

Matrix6 chosen_tip_damping(const Gains& gains, const ArmTerms& terms,
                           const JointElasticity* elastic) noexcept {
  const DampingDesign design = gains.settings.damping;
  if (design == DampingDesign::kGiven) return gains.D_x;
  if (reckons_with(elastic, design)) {
    return elastic_tip_damping(*elastic, terms, gains.K_x, gains.damping_ratio);
  }
  return tip_damping(design, terms.tip, gains.K_x, gains.damping_ratio);
}

}  // namespace limber::controller
