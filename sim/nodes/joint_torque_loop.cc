#include "sim/nodes/joint_torque_loop.h"

#include <algorithm>
#include <cmath>

namespace limber::sim {
namespace {

constexpr double kDerivativeWeight = 0.5;
// Simulated time is in whole nanoseconds, a sample's time need not be.
constexpr double kTolerance_ns = 1000.0;

}  // namespace

JointTorqueLoop::JointTorqueLoop(const TorqueLoopConfig& config) : rate_hz_(config.rate_hz) {
  const double samples = std::round(config.delay_s * config.rate_hz);
  delay_ = static_cast<std::size_t>(std::clamp(samples, 0.0, double{kMaxDelay}));
}

void JointTorqueLoop::update(double sensed_torque, std::int64_t now_ns) noexcept {
  const auto samples = static_cast<std::int64_t>(
      std::floor((static_cast<double>(now_ns) + kTolerance_ns) * 1e-9 * rate_hz_));
  if (samples == samples_) return;
  const double before = samples_ == 0 ? sensed_torque : sensed_;
  samples_ = samples;
  sensed_ = sensed_torque;
  derivative_ += kDerivativeWeight * ((sensed_torque - before) * rate_hz_ - derivative_);
  newest_ = (newest_ + 1) % past_.size();
  past_[newest_] = sensed_ + lead_s_ * derivative_;
}

}  // namespace limber::sim
