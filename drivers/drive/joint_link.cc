#include "drivers/drive/joint_link.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limber {
namespace {

/// A motor that winds up its spring is faster than its link: by what the torque grows, over the
/// spring's stiffness at rest; of two motors, by as much again as the link.
double winding_speed(const JointConfig& joint) noexcept {
  if (joint.has_antagonist) return joint.velocity_limit;
  if (joint.rigid()) return 0.0;
  const SpringConfig& spring = joint.transmission.spring;
  const double stiffness = spring.stiffness_Nm_per_rad + spring.force_Nm * spring.rate_per_rad;
  return joint.torque_rate_limit_Nm_per_s / stiffness;
}

bool finite(const DriveReport& report) noexcept {
  return std::isfinite(report.angle_rad) && std::isfinite(report.link_angle_rad);
}

}  // namespace

JointLink::JointLink(const JointConfig& joint, bool fd, double period_s, int bridged_cycles)
    : joint_(joint),
      family_(make_drive_family(joint, fd, period_s)),
      longest_gap_(bridged_cycles + 1),
      jump_per_cycle_(1.5 * (joint.velocity_limit + winding_speed(joint)) * period_s),
      link_jump_per_cycle_(1.5 * joint.velocity_limit * period_s),
      jump_resolution_(2.0 * family_.codec->angle_resolution()),
      link_jump_resolution_(2.0 * std::ldexp(2.0 * std::numbers::pi, -joint.link_encoder.bits)) {
  seen_.angle_rad = joint.drive.offset_rad;
}

CanFrame JointLink::torque(double tau) noexcept { return command({theta(), 0.0, 0.0, tau}); }

CanFrame JointLink::command(const JointCommand& command) noexcept {
  CanFrame frame;
  const DriveCommand wanted{drive_angle(command.theta), 0.0, command.kp, command.kd,
                            sign() * command.tau};
  commanded_ = family_.codec->command(wanted, memory(), &frame, &sent_);
  return commanded_ ? frame : family_.codec->state_request();
}

CanFrame JointLink::disable() noexcept {
  commanded_ = false;
  return family_.codec->disable();
}

CanFrame JointLink::clear_error() noexcept {
  commanded_ = false;
  return family_.codec->clear_error();
}

CanFrame JointLink::enable() noexcept {
  commanded_ = false;
  return family_.codec->enable(memory());
}

CanFrame JointLink::state_request() noexcept {
  commanded_ = false;
  return family_.codec->state_request();
}

bool JointLink::receive(const CanFrame& frame, std::int32_t age_cycles) noexcept {
  DriveReport report;
  const bool late = age_cycles > 0;
  if (age_cycles_ <= age_cycles) return false;
  const StateReading reading = family_.codec->read_state(frame, late, &report);
  if (reading == StateReading::kPart) return true;
  if (reading == StateReading::kNone) return false;
  if (!angle_known_ && finite(report)) {
    turns_ = {};
    turns_ = whole_turns(angle(report), joint_);
  }
  if (!plausible(report)) {
    if (!takes_jumps_ || age_cycles_ <= longest_gap_ || !finite(report)) return false;
    jumped_ = true;
  }
  seen_ = report;
  angle_known_ = true;
  age_cycles_ = age_cycles;
  return true;
}

bool JointLink::plausible(const DriveReport& report) const noexcept {
  if (!angle_known_) return finite(report);
  const int cycles = std::clamp(age_cycles_, 1, longest_gap_);
  return std::abs(angle(report) - theta()) <= cycles * jump_per_cycle_ + jump_resolution_ &&
         (!has_link_encoder() || std::abs(report.link_angle_rad - seen_.link_angle_rad) <=
                                     cycles * link_jump_per_cycle_ + link_jump_resolution_);
}

void JointLink::begin_cycle() noexcept {
  family_.codec->begin_cycle();
  family_.startup->begin_cycle();
  family_.intruders->begin_cycle();
  if (age_cycles_ < kNever - 1) ++age_cycles_;
}

double JointLink::tau_applied() const noexcept {
  if (!commanded_ || !enabled()) return 0.0;
  return sign() *
         (sent_.kp_Nm_per_rad * (sent_.angle_rad - seen_.angle_rad) +
          sent_.kd_Nms_per_rad * (sent_.speed_rad_per_s - seen_.speed_rad_per_s) + sent_.torque_Nm);
}

}  // namespace limber
