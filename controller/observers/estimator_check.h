// Whether a velocity estimator can follow the arm.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/types.h"
#include "controller/kinds/law_settings.h"
#include "controller/model/arm_terms.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// Levant's differentiator follows accelerations up to its bound L, and none beyond: a joint that
/// accelerates faster leaves the estimate behind, which then damps with the wrong sign. So L may
/// not be below what each joint's own torque makes in the present pose,
///   tau_max,i (M^-1)_ii,  and  tau_max,i / B_i  of a motor behind a spring.
class EstimatorCheck {
 public:
  /// `torque_Nm`: limits of the joints, n. Set-up only.
  EstimatorCheck(const Robot& robot, const VectorJ& torque_Nm)
      : joints_(robot.joint_names()), torque_(torque_Nm) {
    for (const JointConfig& joint : robot.joints) rigid_.push_back(joint.rigid());
  }

  /// nullptr, or which joint exceeds the bound and by what. The text lasts until the next call. In
  /// the cycle.
  const char* check(const LawSettings& settings, const ArmTerms& terms) noexcept;

 private:
  std::vector<std::string> joints_;
  std::vector<bool> rigid_;
  VectorJ torque_;
  std::array<char, 240> text_{};
};

}  // namespace limber::controller
