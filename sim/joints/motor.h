// One motor of a joint: drive law, actuator, friction, and the spring that carries its torque to
// the link.
//
//   B theta'' = tau_m - tau_f - T,   T on the link's side as in sim/joints/transmission.h
//
// On a rigid joint theta = q, the link carries B, and torque and friction act on the link.
#pragma once

#include "robots/loader/robot.h"
#include "sim/joints/actuator.h"
#include "sim/joints/coupling.h"
#include "sim/joints/drive_law.h"
#include "sim/joints/friction.h"
#include "sim/joints/stand.h"
#include "sim/joints/transmission.h"

namespace limber::sim {

/// A motor and its link; on rigid joints twice the same.
struct MotorPoint {
  double theta = 0.0;
  double theta_dot = 0.0;
  double q = 0.0;
  double v = 0.0;
};

/// After construction every member is allowed in the cycle. begin_step(), then, where the motor is
/// passive(), any number of couple() and finish_step(), else let_go(); then the torques of the
/// step.
class Motor {
 public:
  Motor() = default;
  /// Motor 0 of the joint or its antagonist, 1. The drive believes in a torque constant, N m/A.
  Motor(const JointConfig& joint, int number, double believed_torque_constant, bool friction);

  Stand stand;  ///< holds the motor; none unless set

  /// The actuator's torque is held over the step; an ideal one follows its law within it.
  void begin_step(const DriveLaw& law, const MotorPoint& at, double h) noexcept;
  /// Friction, shorted phases or a stand are at work.
  bool passive() const noexcept { return passive_; }
  bool has_bristle() const noexcept { return friction_.has_bristle(); }
  /// But for what is passive.
  Coupling active(const MotorPoint& at, double h) const noexcept;
  /// Friction is linearised at the guess of the speed at the step's end.
  Coupling couple(const Coupling& active, const MotorPoint& at, double theta_dot_guess,
                  double h) const noexcept;
  void finish_step(const MotorPoint& at, double theta_dot_guess, double theta_dot_end,
                   double h) noexcept;
  void let_go() noexcept { friction_torque_ = stand_torque_ = 0.0; }
  /// As couple(), with what is passive held at what finish_step() found.
  Coupling held(Coupling active) const noexcept {
    active.drive += friction_torque_ + stand_torque_;
    return active;
  }

  double torque(const MotorPoint& at) const noexcept {
    return actuator_.ideal() ? law_.torque(at.theta, at.theta_dot) : held_torque_;
  }
  double friction_torque() const noexcept { return friction_torque_; }  ///< and shorted phases
  double stand_torque() const noexcept { return stand_torque_; }
  double bristle_energy() const noexcept { return friction_.bristle_energy(); }

  double side() const noexcept { return side_; }
  bool rigid() const noexcept { return transmission_.rigid(); }
  const Transmission& transmission() const noexcept { return transmission_; }
  double stretch(const MotorPoint& at) const noexcept { return at.theta - side_ * at.q; }
  double stretch_rate(const MotorPoint& at) const noexcept { return at.theta_dot - side_ * at.v; }
  double transmitted(const MotorPoint& at) const noexcept {
    return transmission_.torque(stretch(at), stretch_rate(at));
  }
  // Behind the motor: of spring alone and with the damper; on rigid joints of motor and friction.
  double spring_torque(const MotorPoint& at) const noexcept {
    return rigid() ? torque(at) + friction_torque_ : transmission_.spring_torque(stretch(at));
  }
  double torque_behind(const MotorPoint& at) const noexcept {
    return rigid() ? torque(at) + friction_torque_ : transmitted(at);
  }
  double stiffness(const MotorPoint& at) const noexcept {
    return rigid() ? 0.0 : transmission_.stiffness(stretch(at));
  }
  /// Lost, W.
  double damper_power(const MotorPoint& at, double transmitted) const noexcept {
    if (!transmission_.damped()) return 0.0;
    return (transmitted - transmission_.spring_torque(stretch(at))) * stretch_rate(at);
  }
  double elastic_energy(const MotorPoint& at) const noexcept {
    return rigid() ? 0.0 : transmission_.energy(stretch(at));
  }
  /// Largest magnitude of an eigenvalue, 1/s, that motor and link have together within the reach of
  /// a step; `link_inertia` is a lower bound.
  double fastest_rate(const DriveLaw& law, const MotorPoint& at, double link_inertia,
                      double h) const noexcept;

  double current_A(const MotorPoint& at) const noexcept;
  /// What the drive takes its torque for, N m.
  double estimated_torque(const MotorPoint& at) const noexcept;
  double winding_degC() const noexcept { return actuator_.winding_degC(); }

 private:
  AffineForce opposing(const MotorPoint& at, double theta_dot_guess, double h) const noexcept;

  Actuator actuator_;
  LugreFriction friction_;
  Transmission transmission_;
  double inertia_ = 0.0;  // B
  double side_ = 1.0;
  double torque_constant_ = 1.0;
  double believed_torque_constant_ = 1.0;
  bool hydraulic_ = false;

  DriveLaw law_;  // of the step in progress, and the torques held over it
  double held_torque_ = 0.0;
  double friction_torque_ = 0.0;
  double stand_torque_ = 0.0;
  bool passive_ = false;
};

}  // namespace limber::sim
