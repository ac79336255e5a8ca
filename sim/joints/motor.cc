#include "sim/joints/motor.h"

#include <cmath>

namespace limber::sim {

Motor::Motor(const JointConfig& joint, int number, double believed_torque_constant, bool friction)
    : transmission_(joint.transmission),
      side_(Transmission::side(number)),
      believed_torque_constant_(believed_torque_constant) {
  const DriveConfig& drive = number == 0 ? joint.drive : joint.antagonist;
  actuator_ = Actuator(drive, believed_torque_constant);
  inertia_ = drive.rotor_inertia_kgm2;
  torque_constant_ = drive.torque_constant_Nm_per_A;
  hydraulic_ = drive.actuator.kind == ActuatorKind::kHydraulic;
  if (friction) friction_ = LugreFriction(joint.friction, inertia_);
}

void Motor::begin_step(const DriveLaw& law, const MotorPoint& at, double h) noexcept {
  law_ = law;
  friction_.begin_step(at.theta_dot, h);
  passive_ = friction_.any() || law.passive_damping > 0.0 || stand.holds();
  if (actuator_.ideal()) return;
  if (law.limit > 0.0) {
    held_torque_ = actuator_.step(law.torque(at.theta, at.theta_dot), at.theta, at.theta_dot, h);
  } else {
    // Phases open: no current flows whatever the speed, and the winding cools.
    actuator_.step(0.0, at.theta, 0.0, h);
    held_torque_ = 0.0;
  }
}

AffineForce Motor::opposing(const MotorPoint& at, double theta_dot_guess, double h) const noexcept {
  const AffineForce friction = friction_.step_force(theta_dot_guess);
  const AffineForce held = stand.step_force(at.theta, h);
  return {friction.offset + held.offset, friction.slope + held.slope + law_.passive_damping};
}

Coupling Motor::active(const MotorPoint& at, double h) const noexcept {
  Coupling out;
  out.side = side_;
  out.drive = torque(at);
  out.rigid = rigid();
  out.inertia = 0.0;
  if (out.rigid) return out;
  const bool follows_law = actuator_.ideal() && std::abs(out.drive) < law_.limit;
  if (follows_law) out.servo = 0.25 * h * h * law_.kp + 0.5 * h * law_.kd;
  out.inertia = inertia_ + out.servo;
  out.transmitted = transmitted(at);
  out.gain = 0.25 * h * h * transmission_.stiffness(stretch(at)) +
             0.5 * h * transmission_.damping(stretch(at));
  return out;
}

Coupling Motor::couple(const Coupling& active, const MotorPoint& at, double theta_dot_guess,
                       double h) const noexcept {
  const AffineForce force = opposing(at, theta_dot_guess, h);
  Coupling out = active;
  out.inertia += h * force.slope;
  out.drive -= force.offset + force.slope * at.theta_dot;
  return out;
}

void Motor::finish_step(const MotorPoint& at, double theta_dot_guess, double theta_dot_end,
                        double h) noexcept {
  friction_torque_ =
      -friction_.finish_step(theta_dot_guess, theta_dot_end) - law_.passive_damping * theta_dot_end;
  stand_torque_ = stand.torque(at.theta, theta_dot_end, h);
}

double Motor::fastest_rate(const DriveLaw& law, const MotorPoint& at, double link_inertia,
                           double h) const noexcept {
  if (rigid()) return 0.0;
  const double reach = std::abs(stretch(at)) + h * std::abs(stretch_rate(at));
  const double mobility = 1.0 / inertia_ + 1.0 / link_inertia;
  const double k = transmission_.greatest_stiffness(reach) * mobility + law.kp / inertia_;
  const double d = 0.5 * (transmission_.greatest_damping() * mobility + law.kd / inertia_);
  return d * d > k ? d + std::sqrt(d * d - k) : std::sqrt(k);
}

double Motor::current_A(const MotorPoint& at) const noexcept {
  return actuator_.ideal() ? torque(at) / torque_constant_ : actuator_.current_A();
}

double Motor::estimated_torque(const MotorPoint& at) const noexcept {
  if (actuator_.ideal() || hydraulic_) return torque(at);
  return believed_torque_constant_ * actuator_.current_A();
}

}  // namespace limber::sim
