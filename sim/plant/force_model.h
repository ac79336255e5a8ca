// All forces on links and motors but gravity and inertia: the same code under both integrators.
#pragma once

#include <array>
#include <cstdint>

#include "robots/loader/robot.h"
#include "sim/joints/drive_law.h"
#include "sim/joints/end_stop.h"
#include "sim/joints/friction.h"
#include "sim/joints/motor.h"
#include "sim/joints/stand.h"
#include "sim/plant/arm_state.h"
#include "sim/world/environment.h"

namespace limber::sim {

/// Power into arm and rotors, W; after integration work, J.
struct Work {
  double motor = 0.0;
  double external = 0.0;  ///< pushes, wall, end stops, stand
  double friction = 0.0;  ///< negative: friction and the joints' dampers take it out
};

/// Torque on the links and on the rotors behind springs (zero for others), N m.
struct ArmTorque {
  VectorJ link;
  VectorM motor;
};

/// A step begins with begin_step(), which settles what must be implicit to be stable (friction,
/// shorted phases, end stops) and holds it over the step; evaluate() then gives the total at any
/// state within the step. All members but the constructor are allowed in the cycle.
class ForceModel {
 public:
  /// With `friction` false, joints have neither bristles nor viscous friction. `believed`: what the
  /// drives know of their motors; the motors themselves are those of `robot`.
  ForceModel(const Robot& robot, const Robot& believed, bool friction);
  ForceModel(const Robot& robot, bool friction) : ForceModel(robot, robot, friction) {}

  std::array<DriveLaw, kMaxMotors> drives;
  Environment environment;
  std::array<Stand, kMaxJoints> stands;  ///< none unless set
  void set_motor_stand(int motor, const Stand& stand) noexcept { motors_[motor].stand = stand; }
  /// How much is left of the stands of links and motors.
  void set_stands_left(double left) noexcept;

  /// `arm` is at x, at simulated time t. Solves for the velocity at the end of the step
  ///   (M + B + h S) (v_end - v) / h = tau(q, v) - offset - S v - C v - g
  /// with the passive forces offset + S v_end, re-linearised up to three times, and motors behind
  /// springs as in sim/joints/coupling.h. Where nothing passive acts there is nothing to solve.
  void begin_step(LinkDynamics* arm, const ArmState& x, double h, std::int64_t t_ns) noexcept;

  /// Sets the wrenches of `arm`, which is at x, and gives torque and power of all.
  void evaluate(LinkDynamics* arm, const ArmState& x, ArmTorque* tau, Work* power) const noexcept;

  /// The step in progress as one implicit step from x on: what the links feel, of which
  /// `inertia` times acceleration is to be taken, with the motors behind springs eliminated.
  void couple(const ArmState& x, double h, VectorJ* tau, VectorJ* inertia) noexcept;
  /// Then, with the links' accelerations, those of the motors.
  void motor_accelerations(const VectorJ& qdd, VectorM* out) const noexcept;
  /// Power of the torques of such a step along the velocities at its end x, but for wall and
  /// pushes.
  Work step_power(const ArmState& x, const VectorM& theta_ddot) const noexcept;

  /// Sets the wrenches of `arm` as they are in the step in progress; returns their power.
  double apply_environment(LinkDynamics* arm) const noexcept {
    return environment.apply(arm, t_ns_);
  }

  /// See Motor::fastest_rate().
  double fastest_rate(const ArmState& x, int motor, double link_inertia, double h) const noexcept {
    return motors_[motor].fastest_rate(drives[motor], point(x, motor), link_inertia, h);
  }

  // Of the step in progress or the last one; positive accelerates the joint positively.
  VectorJ friction_torque() const noexcept;                             ///< of motors and links
  const VectorJ& stop_torque() const noexcept { return stop_torque_; }  ///< end stops and stand
  double bristle_energy() const noexcept;
  double elastic_energy(const ArmState& x) const noexcept;  ///< of the joints' springs, J
  // What a joint's springs exert on its link; on rigid joints what motor and its friction do.
  double spring_torque(const ArmState& x, int joint) const noexcept;
  /// With the dampers.
  double joint_torque(const ArmState& x, int joint) const noexcept;
  double joint_stiffness(const ArmState& x, int joint) const noexcept;  ///< zero on rigid joints

  // Motor by motor.
  int motors() const noexcept { return motor_count_; }
  int joint_of(int motor) const noexcept { return joint_of_[motor]; }
  int first_motor(int joint) const noexcept { return first_motor_[joint]; }
  /// One past the joint's last.
  int end_motor(int joint) const noexcept {
    return joint + 1 < size_ ? first_motor_[joint + 1] : motor_count_;
  }
  const Motor& motor(int motor) const noexcept { return motors_[motor]; }
  MotorPoint point(const ArmState& x, int motor) const noexcept {
    const int joint = joint_of_[motor];
    return {x.theta[motor], x.theta_dot[motor], x.q[joint], x.v[joint]};
  }

 private:
  void soften_contacts(LinkDynamics* arm, double h) noexcept;
  /// Friction, an end stop, a stand or shorted phases act in a step from x on.
  bool passive(const ArmState& x) const noexcept;
  void settle(LinkDynamics* arm, const ArmState& x, double h) noexcept;
  void let_go() noexcept;
  /// What does not depend on the guess of the speed at the step's end.
  void begin_couplings(const ArmState& x, double h) noexcept;
  void couple_passive(const ArmState& x, double h) noexcept;
  void finish_step(const ArmState& x, double h) noexcept;

  int size_;
  int motor_count_ = 0;
  std::array<Motor, kMaxMotors> motors_;
  std::array<int, kMaxMotors> joint_of_{};
  std::array<int, kMaxJoints> first_motor_{};
  std::array<LugreFriction, kMaxJoints> friction_;
  std::array<EndStop, kMaxJoints> stops_;
  bool has_bristle_ = false;  // one of the joints
  bool passive_ = false;      // the step in progress
  VectorJ link_friction_;
  VectorJ stop_torque_;
  std::int64_t t_ns_ = 0;
  // Work space of a step.
  std::array<AffineForce, kMaxJoints> stopped_;  // end stops and stands
  std::array<Coupling, kMaxMotors> active_, couplings_;
  VectorJ tau_, inertia_, qdd_, v_guess_, v_end_;
  VectorM theta_dot_guess_, theta_dot_end_, theta_ddot_;
};

}  // namespace limber::sim
