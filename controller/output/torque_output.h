// From the torque that is wanted to the torque that is sent.
#pragma once

#include "controller/elastic/joint_springs.h"
#include "controller/output/joint_limits.h"
#include "controller/output/preload_servo.h"
#include "controller/output/rate_relief.h"
#include "controller/output/torque_blend.h"

namespace limber::controller {

/// What the drives get while no law runs.
struct Standby {
  enum class Torque {
    kAsSent,   ///< stays what the drives apply
    kGravity,  ///< carries the weight
    kZero,
  };
  Torque torque = Torque::kZero;
  bool in_steps = false;  ///< not faster than the gate lets pass
  PreloadAtRest preload = PreloadAtRest::kReleased;
};

/// Joint limits, blend after a switch, relief of springs, torque and rate limit, preload; owns the
/// torque sent last. All members may be called in the cycle.
class TorqueOutput {
 public:
  explicit TorqueOutput(const Robot& robot)
      : limits_(robot),
        blend_(robot.size()),
        preload_(robot),
        springs_(JointSprings(robot).any()),
        walls_(VectorJ::Zero(robot.size())) {}

  /// The torque that is shaped next differs by a jump from the one before: it is blended.
  void blend_next() noexcept { blend_next_ = true; }
  /// Steps are counted from what the drives apply, where they have not followed the last torque.
  void follow_drives(const ArmState& state) noexcept {
    if (limits_.far_from_previous(state.tau_applied, state.period_s)) {
      limits_.set_previous(state.tau_applied);
    }
  }
  /// One cycle. `preload`: wanted by the law, n, rad; nullptr: robot.yaml's; deflection: n, rad.
  /// Adds LIMIT_* bits. False if the torque is not finite; the last one stays.
  bool shape(VectorJ tau, const VectorJ* preload, const ArmState& state, const ArmTerms& terms,
             const VectorJ& deflection, double dt_s, std::int32_t* limits) noexcept;
  /// One cycle without a law, towards `target`. Adds LIMIT_* bits.
  void stand_by(VectorJ target, const Standby& how, const ArmState& state,
                std::int32_t* limits) noexcept;

  const VectorJ& torque() const noexcept { return limits_.previous(); }
  /// Of two motors the sum of their torques, n; zero for joints with one.
  const VectorJ& preload_torque() const noexcept { return preload_.torque(); }
  /// Of the soft walls in the last shape(), n; zero after stand_by().
  const VectorJ& walls() const noexcept { return walls_; }
  const VectorJ& torque_limit() const noexcept { return limits_.torque_limit(); }

 private:
  JointLimits limits_;
  TorqueBlend blend_;
  PreloadServo preload_;
  bool springs_;
  RateRelief relief_;
  VectorJ walls_;
  bool blend_next_ = false;
};

}  // namespace limber::controller
