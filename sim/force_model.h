// All forces on the arm but gravity and inertia: the same code under both integrators.
#pragma once

#include <array>
#include <cstdint>

#include "robots/robot.h"
#include "sim/environment.h"
#include "sim/joints/drive_law.h"
#include "sim/joints/end_stop.h"
#include "sim/joints/friction.h"
#include "sim/joints/stand.h"

namespace limber::sim {

/// Power into the arm, W; after integration work, J.
struct Work {
  double motor = 0.0;
  double external = 0.0;  ///< pushes, wall, end stops, stand
  double friction = 0.0;  ///< negative: friction takes it out
};

/// A step begins with begin_step(), which settles what must be implicit to be stable (friction,
/// shorted phases, end stops) and holds it over the step; evaluate() then gives the total at any
/// state within the step. All members but the constructor are allowed in the cycle.
class ForceModel {
 public:
  /// With `friction` false, joints have neither bristles nor viscous friction.
  ForceModel(const Robot& robot, bool friction);

  std::array<DriveLaw, kMaxJoints> drives;
  Environment environment;
  std::array<Stand, kMaxJoints> stands;  ///< none unless set

  /// `arm` is at (q, v), at simulated time t. Solves for the velocity at the end of the step
  ///   (M + B + h S) (v_end - v) / h = tau(q, v) - offset - S v - C v - g
  /// with the passive forces offset + S v_end, re-linearised up to three times.
  void begin_step(ArticulatedBody* arm, const VectorJ& q, const VectorJ& v, double h,
                  std::int64_t t_ns) noexcept;

  /// Sets the wrenches of `arm`, which is at (q, v), and gives the joint torque and the power of
  /// all.
  void evaluate(ArticulatedBody* arm, const VectorJ& q, const VectorJ& v, VectorJ* tau,
                Work* power) const noexcept;

  /// Sets the wrenches of `arm` as they are in the step in progress; returns their power.
  double apply_environment(ArticulatedBody* arm) const noexcept {
    return environment.apply(arm, t_ns_);
  }

  // Of the step in progress or the last one; positive accelerates the joint positively.
  const VectorJ& friction_torque() const noexcept { return friction_torque_; }
  const VectorJ& stop_torque() const noexcept { return stop_torque_; }  ///< end stops and stand
  double bristle_energy() const noexcept;

 private:
  void soften_wall(ArticulatedBody* arm, double h) noexcept;
  AffineForce passive_force(int joint, double q, double v, double v_guess, double h) const noexcept;

  int size_;
  std::array<LugreFriction, kMaxJoints> friction_;
  std::array<EndStop, kMaxJoints> stops_;
  VectorJ friction_torque_;
  VectorJ stop_torque_;
  std::int64_t t_ns_ = 0;
  // Work space of begin_step().
  VectorJ tau_, slope_, qdd_, v_guess_, v_end_;
};

}  // namespace limber::sim
