// The last hand on the torque before it leaves: what the gate would trip on never gets there.
#pragma once

#include <cstdint>
#include <vector>

#include "common/types.h"
#include "controller/model/arm_state.h"
#include "controller/model/arm_terms.h"
#include "controller/output/stopping.h"
#include "controller/output/torque_limiter.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// Limits of every joint, in the order they act. The gate in the driver trips; these shape. All
/// judge the velocities that the drives report, never an estimate:
///   walls     from 0.10 rad (0.10 m) inside the ends on, at most a tenth of the range, a spring
///             that reaches half the joint's torque at the end (less where the joint is so light
///             that it would swing by more than 0.15 rad of phase a cycle), and a damper against
///             motion into the wall (of the motor where it has a spring before it). A joint that
///             the torque finds in its wall is led out: there the wall begins where it is, and
///             moves back to its place at 0.1 rad/s (m/s), a tenth of its width before the joint
///             at most: what holds the joint against it, a bench or a hand, may let go at once;
///   power     where the net power of all joints would exceed the arm's limit, the torque beyond
///             what carries the weight is scaled down to it, by one factor for all joints;
///   position  in the inner half of the wall what else pushes outwards fades, to zero at the end:
///             the wall alone acts there, so that an arm at rest is inside;
///   torque    clamped to the limit;
///   rate      the step from the torque sent before is clamped to 80 % of what the gate lets pass,
///             that from the torque the drives apply to 90 %: an answer that came too late for its
///             cycle lies between the two, and the gate counts from what the drives apply;
///   stopping  a joint stays slow enough to be stopped before its end and below its velocity limit,
///             by torques that the two before allow (Stopping).
class JointLimits {
 public:
  explicit JointLimits(const Robot& robot);

  /// The torque the next step is counted from. May be called in the cycle.
  void set_previous(const VectorJ& tau) noexcept;
  /// True if any joint is further from the previous torque than the gate lets pass in a cycle: then
  /// the driver has not followed. May be called in the cycle.
  bool far_from_previous(const VectorJ& tau, double period_s) const noexcept;

  /// The arm is without a law: walls begin where joints are in them. In the cycle.
  void rest(const VectorJ& q) noexcept;
  /// Such walls move on to their place, and no further before joints at q. Once a cycle, in it.
  void lead_out(const VectorJ& q, double period_s) noexcept;
  /// Torque of the walls alone, n, N m. In the cycle.
  VectorJ walls(const ArmState& state, const MatrixJ& M) const noexcept;
  /// Power and position: changes `tau`, of which `walls` is a part, returns the LIMIT_* bits that
  /// acted. In the cycle.
  std::int32_t shape(const ArmState& state, const ArmTerms& terms, const VectorJ& walls,
                     VectorJ* tau) const noexcept;
  /// Torque and rate: clamps a finite `tau`, makes it the previous torque, returns the LIMIT_* bits
  /// that acted. In the cycle.
  std::int32_t clamp(double period_s, VectorJ* tau) noexcept;
  /// Likewise, counted from what the drives apply besides, and then stopping, by what torques can
  /// be had in this cycle.
  std::int32_t clamp(const ArmState& state, const ArmTerms& terms, VectorJ* tau) noexcept;

  const VectorJ& torque_limit() const noexcept { return limiter_.torque(); }
  const VectorJ& previous() const noexcept { return limiter_.previous(); }

 private:
  bool scale_for_power(const VectorJ& v, const VectorJ& g, VectorJ* tau) const noexcept;
  bool fade_at_ends(const ArmState& state, const VectorJ& g, const VectorJ& walls,
                    VectorJ* tau) const noexcept;
  /// Where the walls of all joints begin, rad or m.
  struct Edges {
    VectorJ low;
    VectorJ high;
  };
  /// Where a joint is in its wall: rad (m) behind the edge, not positive out of it; and which way
  /// is outwards.
  struct InWall {
    double depth;
    double outwards;
  };
  static InWall in_wall(const Edges& edges, double q, Eigen::Index i) noexcept;

  std::vector<bool> rigid_;
  VectorJ wall_;  // width of the soft wall, rad or m
  Edges place_;
  Edges now_;  // further out while a joint is led out
  VectorJ torque_rate_;
  double power_W_;
  TorqueLimiter limiter_;
  Stopping stopping_;
};

}  // namespace limber::controller
