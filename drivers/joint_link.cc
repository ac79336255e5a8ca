#include "drivers/joint_link.h"

#include <algorithm>
#include <cmath>

namespace limber {
namespace {

constexpr int kPositionBits = 16;
constexpr int kBits = 12;
constexpr double kPositionMargin_rad = 0.02;

}  // namespace

JointLink::JointLink(const JointConfig& joint, bool fd, double period_s, int bridged_cycles)
    : joint_(joint),
      fd_(fd),
      longest_gap_(bridged_cycles + 1),
      jump_per_cycle_(1.5 * joint.velocity_limit * period_s),
      jump_resolution_(4.0 * mit::half_count(joint.drive.range.position_rad, kPositionBits)),
      torque_count_(2.0 * mit::half_count(joint.drive.range.torque_Nm, kBits)) {}

CanFrame JointLink::torque(double tau) noexcept { return command({q_, 0.0, 0.0, tau}); }

CanFrame JointLink::command(const JointCommand& command) noexcept {
  const DriveConfig& drive = joint_.drive;
  const double limit = std::min(joint_.torque_limit_Nm, drive.range.torque_Nm);
  const double most = std::max(limit - 0.5 * torque_count_, 0.0);
  const double tau = drive.sign * command.tau + carry_;
  const double wanted = std::isfinite(tau) ? std::clamp(tau, -most, most) : tau;
  const mit::Command asked{drive.sign * command.q + drive.offset_rad, 0.0, command.kp, command.kd,
                           wanted};
  CanFrame frame;
  if (!mit::encode_command(asked, drive.range, drive.command_id, fd_, mit::Quantiser::kRound,
                           &frame) ||
      !mit::decode_command(frame, drive.range, &sent_)) {
    carry_ = 0.0;
    return state_request();
  }
  carry_ = wanted - sent_.torque_Nm;
  commanded_ = true;
  return frame;
}

CanFrame JointLink::special(mit::Special special) noexcept {
  commanded_ = false;
  carry_ = 0.0;
  return mit::encode_special(special, joint_.drive.command_id, fd_);
}

CanFrame JointLink::state_request() noexcept {
  commanded_ = false;
  return mit::encode_state_request(static_cast<std::uint16_t>(joint_.drive.command_id), fd_);
}

bool JointLink::receive(const CanFrame& frame) noexcept {
  const DriveConfig& drive = joint_.drive;
  mit::Reply reply;
  if (fresh() || !mit::decode_reply(frame, drive.range, &reply)) return false;
  if (reply.id_nibble != (drive.command_id & 0xF)) return false;
  const MitRange& range = drive.range;
  const double angle =
      reply.position_rad + mit::half_count(range.position_rad, kPositionBits) - drive.offset_rad;
  if (!plausible(drive.sign * angle)) return false;
  q_ = drive.sign * angle;
  v_ = drive.sign * (reply.velocity_rad_per_s + mit::half_count(range.velocity_rad_per_s, kBits));
  tau_ = drive.sign * (reply.torque_Nm + mit::half_count(range.torque_Nm, kBits));
  status_ = reply.error;
  temperature_degC_ = reply.rotor_temperature_degC;
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
  return drive.sign * (sent_.kp_Nm_per_rad * (sent_.position_rad - angle) +
                       sent_.kd_Nms_per_rad * (sent_.velocity_rad_per_s - speed) + sent_.torque_Nm);
}

bool JointLink::drive_error() const noexcept {
  return ever_answered() && status_ != mit::DriveError::kEnabled &&
         status_ != mit::DriveError::kDisabled;
}

bool JointLink::out_of_range() const noexcept {
  return ever_answered() && !(q_ >= joint_.position_min - kPositionMargin_rad &&
                              q_ <= joint_.position_max + kPositionMargin_rad);
}

}  // namespace limber
