// Whether a stiffness is stable at the sampling rate, mode by mode.
#pragma once

#include <array>

#include "controller/elastic/joint_elasticity.h"
#include "controller/gains/gains.h"
#include "controller/model/arm_terms.h"

namespace limber::controller {

/// One mode of M s^2 + D s + K.
struct StiffnessMode {
  double frequency_rad_per_s = 0.0;  ///< natural
  double share = 0.0;                ///< stiffness over the stiffest that is stable
};

/// The modes of a spring, softest first; those without stiffness are left out.
struct StiffnessModes {
  std::array<StiffnessMode, kMaxJoints> modes{};
  int count = 0;

  /// 0 without a mode; NaN or more than 1: unstable.
  double highest_share() const noexcept;
};

/// Of K_x through the arm, and of K_q, with the damping that `gains` ask for. `terms`: Jacobian and
/// inertia with rotors at a pose; T: control period, s. The torque takes one cycle to the motor
/// (sampling_limits.h). Friction is left out, so an arm with it is more stable. In the cycle.
///
/// With springs in the joints and damping designed for them, the share is that of the motors, which
/// swing between law and spring (elastic_damping.h). `elastic` nullptr: rigid joints.
StiffnessModes tip_modes(const Gains& gains, const ArmTerms& terms, double T,
                         const JointElasticity* elastic = nullptr) noexcept;
StiffnessModes joint_modes(const Gains& gains, const ArmTerms& terms, double T,
                           const JointElasticity* elastic = nullptr) noexcept;

/// Checks both springs of gains, whatever the law: any law may be selected next, and HOLD uses K_q.
class StabilityCheck {
 public:
  explicit StabilityCheck(double T) : T_(T) {}

  /// nullptr if they are stable at this pose, else which is not and by how much. The text lasts
  /// until the next call. In the cycle.
  const char* check(const Gains& gains, const ArmTerms& terms,
                    const JointElasticity* elastic = nullptr) noexcept;

 private:
  double T_;
  std::array<char, 160> text_{};
};

}  // namespace limber::controller
