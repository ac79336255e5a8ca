// Whether springs and dampers are stable at the sampling rate, mode by mode.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "controller/elastic/joint_elasticity.h"
#include "controller/kinds/gains.h"
#include "controller/model/arm_terms.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// One mode of M s^2 + D s + K.
struct StiffnessMode {
  double frequency_rad_per_s = 0.0;  ///< natural
  double share = 0.0;                ///< stiffness over the stiffest that is stable
};

/// The modes of a spring, softest first; those without stiffness are left out. And of the damper
/// beside it, which needs no spring to be too much.
struct StiffnessModes {
  std::array<StiffnessMode, kMaxJoints> modes{};
  int count = 0;
  double damping_share = 0.0;  ///< of a given damper: over the greatest that is stable
  int damped_joint = -1;       ///< which has the largest part in that mode

  /// Of the springs; 0 without a mode; NaN or more than 1: unstable.
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

/// Of K_null and D_null in the directions that the rows of K_x leave free (nullspace.h): a joint
/// that turns about the tool's own axis is one of them where K_x has no rotation.
StiffnessModes null_modes(const Gains& gains, const ArmTerms& terms, double T) noexcept;

/// Checks all springs and given dampers of gains, whatever the law: any law may be selected next,
/// and HOLD uses K_q.
class StabilityCheck {
 public:
  /// `joints`: their names. Set-up only.
  StabilityCheck(double T, std::vector<std::string> joints) : T_(T), joints_(std::move(joints)) {}

  /// nullptr if they are stable at this pose, else which is not and by how much. The text lasts
  /// until the next call. In the cycle.
  const char* check(const Gains& gains, const ArmTerms& terms,
                    const JointElasticity* elastic = nullptr) noexcept;

 private:
  const char* judge(const char* spring, const char* damper, const StiffnessModes& modes) noexcept;

  double T_;
  std::vector<std::string> joints_;
  std::array<char, 240> text_{};
};

}  // namespace limber::controller
#pragma GCC visibility pop
