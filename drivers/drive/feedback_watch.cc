#include "drivers/drive/feedback_watch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limber {
namespace {

double link_count(const JointConfig& joint) noexcept {
  return std::ldexp(2.0 * std::numbers::pi, -joint.link_encoder.bits);
}

}  // namespace

FeedbackWatch::FeedbackWatch(const JointLink& link) noexcept
    : velocity_(link.joint().velocity_limit, link.angle_resolution()),
      link_velocity_(link.joint().velocity_limit, link_count(link.joint())),
      torque_(std::min(link.joint().torque_limit_Nm, link.joint().drive.range.torque_Nm)),
      has_link_encoder_(link.joint().link_encoder.present),
      has_torque_sensor_(link.joint().torque_sensor.present) {}

void FeedbackWatch::reset() noexcept {
  velocity_.reset();
  link_velocity_.reset();
  torque_.reset();
  known_ = false;
}

void FeedbackWatch::add(const JointLink& link, double time_s) noexcept {
  velocity_.add(link.theta(), link.theta_dot(), time_s);
  if (has_link_encoder_) link_velocity_.add(link.q(), link.v(), time_s);
  if (known_ && !has_torque_sensor_) torque_.add(link.tau(), link.tau_applied(), time_s - time_s_);
  time_s_ = time_s;
  known_ = true;
}

Contradiction FeedbackWatch::found() const noexcept {
  if (velocity_.contradicts()) return Contradiction::kVelocity;
  if (link_velocity_.contradicts()) return Contradiction::kLinkVelocity;
  return torque_.contradicts() ? Contradiction::kTorque : Contradiction::kNone;
}

}  // namespace limber
