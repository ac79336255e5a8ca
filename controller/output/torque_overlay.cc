#include "controller/output/torque_overlay.h"

#include <cmath>

namespace limber::controller {

TorqueOverlay::TorqueOverlay(const Robot& robot)
    : most_(robot.size()), tau_(VectorJ::Zero(robot.size())) {
  for (int i = 0; i < robot.size(); ++i)
    most_[i] = kShareOfLimit * robot.joints[static_cast<std::size_t>(i)].torque_limit_Nm;
}

Refusal TorqueOverlay::set(const torque_overlay_t& message, std::int64_t now_ns) noexcept {
  if (message.num_joints != most_.size()) return malformed("num_joints is not this arm's");
  if (!(message.valid_for_s > 0.0F && message.valid_for_s <= static_cast<float>(kLongest_s)))
    return beyond_goal_limit("valid_for_s must be within 0..0.05 s");
  const VectorJ tau = Eigen::Map<const Eigen::VectorXf>(message.tau, most_.size()).cast<double>();
  if (!tau.allFinite()) return malformed("tau is not finite");
  if ((most_ - tau.cwiseAbs()).minCoeff() < 0.0)
    return beyond_goal_limit("tau is more than a third of a joint's torque limit");
  tau_ = tau;
  on_ = true;
  end_ns_ = now_ns + std::llround(1e9 * static_cast<double>(message.valid_for_s));
  ++taken_;
  return {};
}

const VectorJ& TorqueOverlay::torque(std::int64_t now_ns) noexcept {
  if (on_ && now_ns > end_ns_) {
    on_ = false;
    tau_.setZero();
    ++expired_;
  }
  return tau_;
}

}  // namespace limber::controller
