// The torque that keeps a resting joint where it is: the mean over 0.2 s of what the controller
// commanded.
//
// A joint rests while its speed is at most 0.05 rad/s and the torque stays within 5 % of the
// joint's limit about the mean. Where the driver holds such a joint because its controller is
// gone, this torque holds it, payload and whatever the model does not know included, and a
// gravity torque that the controller had wrong moves nothing.
#pragma once

#include <cmath>
#include <cstdint>

namespace limber {

/// Allowed inside the cycle. Torque and speed of one joint, N m and rad/s or N and m/s.
class RestTorque {
 public:
  RestTorque(double torque_limit, double rate_hz) noexcept
      : near_(kNear * torque_limit), cycles_(std::llround(std::ceil(kMemory_s * rate_hz))) {}

  /// Once a cycle while the controller's torque is followed.
  void add(double torque, double speed) noexcept {
    if (!(std::abs(speed) <= kRest_per_s) || !(std::abs(torque - mean_) <= near_)) count_ = 0;
    if (count_ == 0) mean_ = torque;
    if (count_ < cycles_) ++count_;
    mean_ += (torque - mean_) / static_cast<double>(count_);
  }

  /// The controller's torque is not followed: what was before is another load's.
  void forget() noexcept { count_ = 0; }

  bool known() const noexcept { return count_ == cycles_; }
  double mean() const noexcept { return mean_; }

 private:
  static constexpr double kMemory_s = 0.2;
  static constexpr double kRest_per_s = 0.05;
  static constexpr double kNear = 0.05;  // of the torque limit

  double near_;
  std::int64_t cycles_;
  std::int64_t count_ = 0;
  double mean_ = 0.0;
};

}  // namespace limber
