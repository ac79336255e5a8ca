#include "drivers/joint_link.h"

#include <algorithm>
#include <cmath>

namespace limber {
namespace {

constexpr double kPositionMargin_rad = 0.02;

}  // namespace

JointLink::JointLink(const JointConfig& joint, bool fd, double period_s, int bridged_cycles)
    : joint_(joint),
      family_(make_drive_family(joint, fd)),
      longest_gap_(bridged_cycles + 1),
      jump_per_cycle_(1.5 * joint.velocity_limit * period_s),
      jump_resolution_(2.0 * family_->angle_resolution()) {}

CanFrame JointLink::torque(double tau) noexcept { return command({q_, 0.0, 0.0, tau}); }

CanFrame JointLink::command(const JointCommand& command) noexcept {
  const DriveConfig& drive = joint_.drive;
  CanFrame frame;
  commanded_ = family_->command({drive.sign * command.q + drive.offset_rad, 0.0, command.kp,
                                 command.kd, drive.sign * command.tau},
                                &frame, &sent_);
  return commanded_ ? frame : family_->state_request();
}

CanFrame JointLink::disable() noexcept {
  commanded_ = false;
  return family_->disable();
}

CanFrame JointLink::clear_error() noexcept {
  commanded_ = false;
  return family_->clear_error();
}

CanFrame JointLink::enable() noexcept {
  commanded_ = false;
  return family_->enable(joint_.drive.sign * q_ + joint_.drive.offset_rad);
}

CanFrame JointLink::state_request() noexcept {
  commanded_ = false;
  return family_->state_request();
}

bool JointLink::receive(const CanFrame& frame) noexcept {
  const DriveConfig& drive = joint_.drive;
  DriveReport report;
  if (fresh() || !family_->read_state(frame, &report)) return false;
  const double q = drive.sign * (report.angle_rad - drive.offset_rad);
  if (!plausible(q)) return false;
  q_ = q;
  v_ = drive.sign * report.speed_rad_per_s;
  tau_ = drive.sign * report.torque_Nm;
  current_A_ = drive.sign * report.current_A;
  temperature_degC_ = report.temperature_degC;
  condition_ = report.condition;
  angle_known_ = true;
  age_cycles_ = 0;
  return true;
}

bool JointLink::plausible(double q) const noexcept {
  if (!angle_known_) return std::isfinite(q);
  const int cycles = std::clamp(age_cycles_, 1, longest_gap_);
  return std::abs(q - q_) <= cycles * jump_per_cycle_ + jump_resolution_;
}

void JointLink::begin_cycle() noexcept {
  if (age_cycles_ < kNever - 1) ++age_cycles_;
}

double JointLink::tau_applied() const noexcept {
  if (!commanded_ || !enabled()) return 0.0;
  const DriveConfig& drive = joint_.drive;
  const double angle = drive.sign * q_ + drive.offset_rad;
  const double speed = drive.sign * v_;
  return drive.sign * (sent_.kp_Nm_per_rad * (sent_.angle_rad - angle) +
                       sent_.kd_Nms_per_rad * (sent_.speed_rad_per_s - speed) + sent_.torque_Nm);
}

bool JointLink::out_of_range() const noexcept {
  return ever_answered() && !(q_ >= joint_.position_min - kPositionMargin_rad &&
                              q_ <= joint_.position_max + kPositionMargin_rad);
}

}  // namespace limber
