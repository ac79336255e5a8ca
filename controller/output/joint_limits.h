// The last hand on the torque before it leaves: what the gate would trip on never gets there.
#pragma once

#include <cstdint>
#include <vector>

#include "common/types.h"
#include "controller/model/arm_state.h"
#include "controller/model/arm_terms.h"
#include "controller/output/torque_limiter.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// Limits of every joint, in the order they act. The gate in the driver trips; these shape:
///   power     where the net power of all joints would exceed the arm's limit, the torque beyond
///             what carries the weight is scaled down to it, by one factor for all joints;
///   velocity  above 80 % of the limit, torque that accelerates further is scaled down, to zero
///             at the limit (the part that carries the weight is not);
///   position  from 0.10 rad (0.10 m) inside the limits on, at most a tenth of the range, a
///             spring that reaches half the joint's torque at the limit, and a damper against
///             motion into the wall (of the motor where it has a spring before it);
///   torque    clamped to the limit;
///   rate      the step from the torque sent before is clamped to 80 % of what the gate lets pass,
///             that from the torque the drives apply to 90 %: an answer that came too late for its
///             cycle lies between the two, and the gate counts from what the drives apply.
class JointLimits {
 public:
  explicit JointLimits(const Robot& robot);

  /// The torque the next step is counted from. May be called in the cycle.
  void set_previous(const VectorJ& tau) noexcept;
  /// True if any joint is further from the previous torque than the gate lets pass in a cycle: then
  /// the driver has not followed. May be called in the cycle.
  bool far_from_previous(const VectorJ& tau, double period_s) const noexcept;

  /// Power, velocity and position: changes `tau`, returns the LIMIT_* bits that acted. In the
  /// cycle.
  std::int32_t shape(const ArmState& state, const ArmTerms& terms, VectorJ* tau) const noexcept;
  /// Torque and rate: clamps a finite `tau`, makes it the previous torque, returns the LIMIT_* bits
  /// that acted. In the cycle.
  std::int32_t clamp(double period_s, VectorJ* tau) noexcept;
  /// Likewise, for drives that apply `applied`.
  std::int32_t clamp(double period_s, const VectorJ& applied, VectorJ* tau) noexcept;

  const VectorJ& torque_limit() const noexcept { return limiter_.torque(); }
  const VectorJ& previous() const noexcept { return limiter_.previous(); }

 private:
  bool scale_for_power(const VectorJ& v, const VectorJ& g, VectorJ* tau) const noexcept;
  bool scale_for_velocity(const ArmState& state, const VectorJ& g, VectorJ* tau) const noexcept;
  bool add_walls(const ArmState& state, const MatrixJ& M, VectorJ* tau) const noexcept;

  VectorJ position_min_;
  VectorJ position_max_;
  std::vector<bool> rigid_;
  VectorJ wall_;  // width of the soft wall, rad or m
  VectorJ velocity_;
  VectorJ torque_rate_;
  double power_W_;
  TorqueLimiter limiter_;
};

}  // namespace limber::controller
