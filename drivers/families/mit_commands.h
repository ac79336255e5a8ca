// Commands of drives that take the five numbers of mit.h.
#pragma once

#include <algorithm>
#include <cmath>

#include "drivers/families/drive_codec.h"
#include "drivers/protocols/mit.h"

namespace limber {

/// The rounding error of the torque field is added to the next torque (first-order noise shaping):
/// the mean over the cycles is exact although a count is up to 63 mN m, and there is no exact zero.
/// Neither that nor rounding carries a torque over the joint's limit. Allowed inside the cycle.
class MitCommands {
 public:
  MitCommands(const JointConfig& joint, std::uint32_t id, bool fd) noexcept
      : range_(joint.drive.range),
        id_(id),
        fd_(fd),
        most_torque_(std::max(std::min(joint.torque_limit_Nm, range_.torque_Nm) -
                                  mit::half_count(range_.torque_Nm, kTorqueBits),
                              0.0)) {}

  /// As DriveCodec::command().
  [[nodiscard]] bool encode(const DriveCommand& command, CanFrame* frame,
                            DriveCommand* sent) noexcept {
    const double tau = command.torque_Nm + carry_;
    const double wanted = std::isfinite(tau) ? std::clamp(tau, -most_torque_, most_torque_) : tau;
    mit::Command decoded;
    if (!mit::encode_command({command.angle_rad, command.speed_rad_per_s, command.kp_Nm_per_rad,
                              command.kd_Nms_per_rad, wanted},
                             range_, id_, fd_, mit::Quantiser::kRound, frame) ||
        !mit::decode_command(*frame, range_, &decoded)) {
      carry_ = 0.0;
      return false;
    }
    carry_ = wanted - decoded.torque_Nm;
    *sent = {decoded.position_rad, decoded.velocity_rad_per_s, decoded.kp_Nm_per_rad,
             decoded.kd_Nms_per_rad, decoded.torque_Nm};
    return true;
  }
  /// No torque of before is made up for.
  void start_afresh() noexcept { carry_ = 0.0; }

 private:
  static constexpr int kTorqueBits = 12;

  CommandRange range_;
  std::uint32_t id_;
  bool fd_;
  double most_torque_;  ///< N m: the limit less what rounding may add
  double carry_ = 0.0;  ///< rounding error not sent yet, N m
};

}  // namespace limber
