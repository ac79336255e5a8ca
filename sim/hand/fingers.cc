#include "sim/hand/fingers.h"

#include <algorithm>

namespace limber::sim {
namespace {

constexpr int kMostGuesses = 4;

/// The fingers' ends are those of the table.
EndStop ends_of(const HandConfig& hand) {
  JointConfig joint = hand.drive;
  const double ends[] = {hand.travel.angle(hand.travel.closed_m()),
                         hand.travel.angle(hand.travel.open_m())};
  joint.position_min = std::min(ends[0], ends[1]);
  joint.position_max = std::max(ends[0], ends[1]);
  return EndStop(joint);
}

}  // namespace

Fingers::Fingers(const HandConfig& hand, double believed_torque_constant, bool friction)
    : travel_(hand.travel),
      rotor_inertia_(hand.drive.drive.rotor_inertia_kgm2),
      finger_mass_(hand.finger_mass_kg),
      motor_(hand.drive, 0, believed_torque_constant, friction),
      stop_(ends_of(hand)),
      theta_(hand.drive.home) {}

void Fingers::step(const DriveLaw& law, const Squeezed& object, double h) noexcept {
  motor_.begin_step(law, point(), h);
  const bool touches = object.stiffness_N_per_m > 0.0 && width() < object.width_m;
  move(touches ? &object : nullptr, h);
}

// Friction is linearised at a guess of the speed at the step's end, which is made again from it.
void Fingers::move(const Squeezed* object, double h) noexcept {
  const MotorPoint at = point();
  const double s = travel_.slope(theta_);
  const double w = width();
  const double inertia = rotor_inertia_ + 0.5 * finger_mass_ * s * s;
  const AffineForce stop = stop_.step_force(theta_, h);
  const Coupling active = motor_.active(at, h);
  AffineForce pressed;
  if (object != nullptr) {
    const double k = object->stiffness_N_per_m;
    pressed = {-s * k * (object->width_m - w), s * s * (object->damping_Ns_per_m + h * k)};
  }
  double guess = theta_dot_;
  double end = theta_dot_;
  for (int i = 0; i < (motor_.has_bristle() ? kMostGuesses : 1); ++i) {
    guess = end;
    const Coupling motor = motor_.couple(active, at, guess, h);
    const double slope = stop.slope + pressed.slope;
    const double offset = stop.offset + pressed.offset;
    end = theta_dot_ +
          h * (motor.drive - offset - slope * theta_dot_) / (inertia + motor.inertia + h * slope);
  }
  const double speed = s * end;
  double force = 0.0;
  if (object != nullptr)
    force = object->stiffness_N_per_m * (object->width_m - w - h * speed) -
            object->damping_Ns_per_m * speed;
  if (force < 0.0) return move(nullptr, h);  // it cannot pull
  motor_.finish_step(at, guess, end, h);
  force_ = force;
  theta_dot_ = end;
  theta_ += h * end;
}

}  // namespace limber::sim
