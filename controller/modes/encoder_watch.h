// Has an encoder stopped counting while its joint moves?
#pragma once

#include <array>
#include <limber/joint_state_t.hpp>
#include <optional>
#include <vector>

#include "common/joints.h"
#include "common/types.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// A reading that does not change by a single bit is normal at rest, also under torque: friction or
/// a wall holds the joint. It is not if the torque would have moved the free joint by kExpected,
///
///   integral integral (|tau - g - balanced| - tau_friction) / M_ii dt^2  >=  kExpected
///
/// where `balanced` is the part of tau - g between zero and what it was when the reading changed
/// last: that much a load or a wall held then, and may still hold or have let go since;
/// and the arm moves meanwhile: another joint by kOthers at least, as it does when this one swings
/// unseen, and does not when the whole arm leans against something. Below tau_friction, the joint's
/// friction in robot.yaml or kFrictionShare of its torque limit, whichever is more, nothing is
/// found. A wrist that hangs on to nothing may turn without moving another joint: not found either.
class EncoderWatch {
 public:
  static constexpr double kExpected = 0.05;  ///< rad (m for prismatic joints)
  static constexpr double kOthers = 0.01;    ///< likewise
  static constexpr double kFrictionShare = 0.05;

  /// For set-up.
  explicit EncoderWatch(const Robot& robot);

  // May be called in the cycle.

  /// Forgets what was seen.
  void reset() noexcept;
  /// Once a cycle with drives that follow: the joint whose encoder has stopped, -1: none. `gravity`
  /// and `M`: of the model, N m and kg m^2; `dt_s`: since the last call.
  int stopped(const joint_state_t& state, const VectorJ& gravity, const MatrixJ& M,
              double dt_s) noexcept;

 private:
  /// Since a joint's reading changed last.
  struct Rest {
    bool continues(const joint_state_t& state, int i) const noexcept;
    bool arm_moved(const joint_state_t& state) const noexcept;

    double theta;  ///< the reading
    double q;
    double theta_dot;
    double v;
    double load_Nm;                         ///< tau - g then
    std::array<double, kMaxJoints> thetas;  ///< of all joints then
    double expected_speed = 0.0;            ///< of the free joint since then, rad/s
    double expected_angle = 0.0;            ///< likewise, rad
  };
  struct Joint {
    double friction_Nm;
    std::optional<Rest> rest;
  };

  std::vector<Joint> joints_;
};

}  // namespace limber::controller
