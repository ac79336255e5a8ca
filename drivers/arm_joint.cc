#include "drivers/arm_joint.h"

#include <cmath>

#include "drivers/drive/motor_view.h"

namespace limber {
namespace {

constexpr double kVelocityMargin = 1.1;

bool within(double x, double low, double high) noexcept {
  return x >= low - kBeyondTravel && x <= high + kBeyondTravel;
}

}  // namespace

ArmJoint::ArmJoint(const Robot& robot, const JointConfig& joint, int bridged_cycles)
    : joint_(joint) {
  for (int motor = 0; motor < joint.motors(); ++motor) {
    const JointConfig view = motor_view(joint, motor);
    const bool fd = robot.buses.at(static_cast<std::size_t>(view.drive.bus)).fd;
    motors_.emplace_back(view, fd, robot.rate_hz, bridged_cycles);
  }
}

// --- towards the motors --------------------------------------------------------------------------

double ArmJoint::share(const JointTorque& torque, std::size_t motor) const noexcept {
  if (!two_motors()) return torque.tau;
  return motor == 0 ? first_share(torque) : second_share(torque);
}

void ArmJoint::enter(DriveState state, const JointTorque& present,
                     const JointTorque& held) noexcept {
  for (std::size_t m = 0; m < motors_.size(); ++m)
    motors_[m].enter(state, share(present, m), share(held, m));
}

void ArmJoint::close_cycle(DriveState state, std::int64_t cycle, double time_s) noexcept {
  for (Drive& motor : motors_) motor.close_cycle(state, cycle, time_s);
  if (!fresh()) return;
  fast_cycles_ = std::abs(v()) <= kVelocityMargin * joint_.velocity_limit ? 0 : fast_cycles_ + 1;
}

void ArmJoint::acknowledge() noexcept {
  for (Drive& motor : motors_) motor.acknowledge();
}

// --- measured ------------------------------------------------------------------------------------

double ArmJoint::q() const noexcept { return joint_.link_encoder.present ? first().q() : theta(); }

double ArmJoint::v() const noexcept {
  return joint_.link_encoder.present ? first().v() : theta_dot();
}

double ArmJoint::theta() const noexcept {
  return two_motors() ? 0.5 * (first().theta() - second().theta()) : first().theta();
}

double ArmJoint::theta_dot() const noexcept {
  return two_motors() ? 0.5 * (first().theta_dot() - second().theta_dot()) : first().theta_dot();
}

double ArmJoint::preload() const noexcept {
  return two_motors() ? 0.5 * (first().theta() + second().theta()) : 0.0;
}

double ArmJoint::preload_dot() const noexcept {
  return two_motors() ? 0.5 * (first().theta_dot() + second().theta_dot()) : 0.0;
}

double ArmJoint::tau() const noexcept {
  const bool sensed = joint_.torque_sensor.present || !two_motors();
  return sensed ? first().tau() : first().tau() - second().tau();
}

JointTorque ArmJoint::applied() const noexcept {
  const double one = first().tau_applied();
  if (!two_motors()) return {one, 0.0};
  const double other = second().tau_applied();
  return {one - other, one + other};
}

std::int32_t ArmJoint::age_cycles() const noexcept {
  return std::max(first().age_cycles(), second().age_cycles());
}

std::int32_t ArmJoint::flags() const noexcept {
  using State = joint_state_t;
  const bool warned =
      std::ranges::any_of(motors_, [](const Drive& motor) { return motor.warning().any(); });
  return (fresh() ? State::JOINT_FRESH : 0) | (enabled() ? State::JOINT_ENABLED : 0) |
         (failed() ? State::JOINT_DRIVE_ERROR : 0) | (warned ? State::JOINT_WARNING : 0) |
         (out_of_range() ? State::JOINT_OUT_OF_RANGE : 0) |
         (joint_.link_encoder.present ? State::JOINT_LINK_ENCODER : 0) |
         (joint_.torque_sensor.present ? State::JOINT_TORQUE_SENSOR : 0) |
         (two_motors() ? State::JOINT_TWO_MOTORS : 0);
}

Contradiction ArmJoint::contradiction() const noexcept {
  for (const Drive& motor : motors_) {
    if (motor.contradiction() != Contradiction::kNone) return motor.contradiction();
  }
  return Contradiction::kNone;
}

std::int64_t ArmJoint::silent_cycles() const noexcept {
  return std::min(motors_.front().missing_cycles(), motors_.back().missing_cycles());
}

bool ArmJoint::out_of_range() const noexcept {
  if (age_cycles() == JointLink::kNever) return false;
  if (!first().turns().known || !within(q(), joint_.position_min, joint_.position_max)) return true;
  const double wound = winding_limit(joint_);
  return two_motors() &&
         !(within(first().theta(), -wound, wound) && within(second().theta(), -wound, wound));
}

bool ArmJoint::ready_to_enable() const noexcept {
  return fresh() && !out_of_range() && fast_cycles_ == 0 && !too_hot();
}

// --- messages ------------------------------------------------------------------------------------

void ArmJoint::write_state(std::size_t i, joint_state_t* state) const noexcept {
  const double one_A = first().current_A();
  const double other_A = second().current_A();
  state->q[i] = q();
  state->v[i] = v();
  state->theta[i] = theta();
  state->theta_dot[i] = theta_dot();
  state->preload[i] = static_cast<float>(preload());
  state->preload_dot[i] = static_cast<float>(preload_dot());
  state->tau[i] = tau();
  state->tau_applied[i] = applied().tau;
  state->tau_preload_applied[i] = static_cast<float>(applied().preload);
  state->current_A[i] = static_cast<float>(std::abs(one_A) >= std::abs(other_A) ? one_A : other_A);
  state->temperature_degC[i] = static_cast<float>(temperature_degC());
  const auto failed = std::ranges::find_if(motors_, &Drive::failed);
  const Drive& told = failed == motors_.end() ? motors_.front() : *failed;
  state->drive_status[i] = static_cast<std::int16_t>(told.link().status());
  state->age_cycles[i] = age_cycles();
  state->joint_flags[i] = flags();
}

void ArmJoint::write_status(std::size_t i, driver_status_t* status) const noexcept {
  status->replies_late[i] = status->replies_lost[i] = status->replies_invalid[i] = 0;
  for (const Drive& motor : motors_) {
    status->replies_late[i] += motor.replies_late();
    status->replies_lost[i] += motor.replies_lost();
    status->replies_invalid[i] += motor.replies_invalid();
  }
}

}  // namespace limber
