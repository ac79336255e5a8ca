// Keeps every joint slow enough to be stopped before its ends, and below its velocity limit.
#pragma once

#include <cstdint>

#include "common/types.h"
#include "controller/elastic/joint_springs.h"
#include "controller/model/arm_state.h"
#include "controller/model/arm_terms.h"
#include "controller/output/torque_limiter.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// Bounds the acceleration of each joint towards an end, or towards its velocity limit, whatever
/// the law, a goal or a feed-forward wrench demands. With u the joint's speed that way, d the way
/// left to the end, a the acceleration that half of the joint's torque brakes with (beyond what
/// carries the weight; where that grows on the way, as with the angle of a rigid joint it does, its
/// mean over the way), and j a third of what the torque's rate limit makes of it as jerk:
///
///   u_most(d) = min(0.8 velocity limit, s(d; kappa, a))           speed that can be stopped in d
///   a_most    = d/dt u_most + s(u_most - u; gamma, j)             acceleration that keeps to it
///   s(x; k, c) = k x near zero, then sqrt(2 c (x - c / (2 k^2)))  from x = c / k^2 on
///
/// s is the speed from which a steady deceleration c stops in x, made linear near rest; the same
/// form takes an acceleration back with a steady jerk.
///
/// The arm as a whole is bounded, too: where one joint's speed throws another with more than a
/// share r of the torque that its weight leaves it, it could not be stopped. Such torques grow with
/// the square of the speeds, so with its kinetic energy E, of which only motors and weight are a
/// source:
///
///   d/dt E = v^T (tau - g)  <=  gamma (E r / max_i(|C v|_i / (torque limit - |g|)_i) - E)
///
/// All these are rows n^T a <= b of the acceleration that the model predicts, and where it predicts
/// more, the torque changes by the least impulse that stops at these joints would exert:
///
///   a = M^-1 (tau - C v - g + r),   tau -= n lambda,   0 <= lambda, b - n^T a >= 0, one of both
///   zero
///   kMemory_s r' = M_links v' + B theta'' + C v + g - tau_applied - r
///
/// by projected Gauss-Seidel. r is what acts besides the motors, a payload, friction or a contact,
/// seen by the change of momentum of links and rotors, in which the springs between them cancel. It
/// counts as far as it holds against the torque, so that a joint at rest may push as hard as its
/// torque allows, and in full where it drives a joint that nears its velocity limit; until it is
/// known, only joints that move are judged. A joint that is braked is judged the other way, too,
/// where its torque would throw it back faster than half of the limit before it has unwound,
/// a^2 / 2j later, or faster than can be stopped if its weight takes most of its torque; so is a
/// joint at rest, if it is so light that its torque can bring it there within two cycles. What
/// torque and rate limits keep from all that is made up for by the joints that can, by least
/// squares: they brake themselves, or change their torque less. Joints do not if their spring is
/// softer than 0.4 M / kMemory_s^2: their link does not follow in time. A joint that leaves its end
/// is not pushed.
///
/// A link between two motors, on such springs that nothing damps, overtakes them when they set off,
/// and is up to twice as fast. So their own speed theta' keeps to a bound w first: 0.8 velocity
/// limit, and half of that while they bend the springs further than the weight does. With the
/// springs' torque tau_J and the rotors' inertia B:
///
///   -B s(w + theta'; 20/s, j)  <=  tau - tau_J - e  <=  B s(w - theta'; 20/s, j)
///   kMemory_s e' = tau_applied - tau_J - B theta'' - e
///
/// e is what the springs pull with beyond what robot.yaml makes of them. It counts in full at rest,
/// where motors must not be moved by what is only believed, and not from 0.2 w on, where it would
/// come too late.
///
/// Judged by the velocities that the drives report; of motor and link, where a spring is between
/// them, the one that is faster that way.
class Stopping {
 public:
  /// `torque_Nm`: limits of the joints, n.
  Stopping(const Robot& robot, const VectorJ& torque_Nm);

  using Reach = TorqueLimiter::Reach;

  static constexpr double kMemory_s = 0.02;

  /// Once a cycle, before shape(): the state and the model there. In the cycle.
  void observe(const ArmState& state, const ArmTerms& terms) noexcept;
  /// Changes `tau` within what can be reached in this cycle, where it is. Returns LIMIT_VELOCITY
  /// and LIMIT_POSITION where they acted. In the cycle.
  std::int32_t shape(const ArmState& state, const ArmTerms& terms, const Reach& reach,
                     VectorJ* tau) const noexcept;

 private:
  struct Row;
  struct Rows;
  void bound_joint(Eigen::Index joint, double sign, const ArmState& state, const ArmTerms& terms,
                   const VectorJ& load, const VectorJ& tau, Rows* rows) const noexcept;
  /// g of the joint, now or in the mean over the next `way` in the direction of `sign`: what leaves
  /// less to brake with.
  double weight_over(double way, Eigen::Index joint, double sign,
                     const ArmTerms& terms) const noexcept;
  /// Whether motor and link move as one within kMemory_s.
  bool firm(Eigen::Index joint, const ArmTerms& terms) const noexcept;
  /// Two motors behind soft springs; returns LIMIT_VELOCITY if it acted.
  std::int32_t bound_motors(const ArmState& state, const ArmTerms& terms, const Reach& reach,
                            VectorJ* tau) const noexcept;
  void bound_energy(const ArmState& state, const ArmTerms& terms, Rows* rows) const noexcept;
  void let_others_help(const Rows& rows, const MatrixJ& W, const ArmState& state,
                       const ArmTerms& terms, const Reach& reach, VectorJ* a,
                       VectorJ* tau) const noexcept;

  JointSprings springs_;
  std::vector<bool> pairs_;  // antagonistic
  bool any_pair_ = false;
  std::vector<bool> turns_rigidly_;
  VectorJ position_min_;
  VectorJ position_max_;
  VectorJ velocity_;
  double speed_gain_per_s_;
  double acceleration_gain_per_s_;
  VectorJ torque_;
  VectorJ torque_rate_;
  VectorJ K_J_;                // of the springs in the joints, infinite without
  std::int64_t time_ns_ = -1;  // of the state before
  double observed_s_ = 0.0;    // without a gap
  VectorJ v_;                  // likewise
  VectorJ theta_dot_;          // likewise
  VectorJ r_;
  VectorJ spring_error_;  // e
  VectorJ spring_Nm_;     // tau_J, and e as far as it counts, of pairs
};

}  // namespace limber::controller
