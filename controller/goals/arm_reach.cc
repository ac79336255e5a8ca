#include "controller/goals/arm_reach.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <kdl/chain.hpp>

#include "robots/loader/load_robot.h"

namespace limber::controller {
namespace {

constexpr double kRounding_m = 1e-6;

}  // namespace

ArmReach::ArmReach(const LoadedRobot& robot) {
  KDL::Frame before = KDL::Frame::Identity();  // of the segment, all joints at zero
  KDL::Vector last;
  std::size_t joint = 0;
  for (const KDL::Segment& segment : robot.chain.segments) {
    if (segment.getJoint().getType() != KDL::Joint::None) {
      const KDL::Vector here = before * segment.getJoint().JointOrigin();
      if (joint == 0) {
        origin_ = Eigen::Vector3d(here.x(), here.y(), here.z());
      } else {
        longest_m_ += (here - last).Norm();
      }
      last = here;
      const JointConfig& config = robot.robot.joints[joint++];
      const bool slides = segment.twist(0.0, 1.0).rot.Norm() == 0.0;
      if (slides)
        longest_m_ += std::max(std::abs(config.position_min), std::abs(config.position_max));
    }
    before = before * segment.pose(0.0);
  }
  longest_m_ += (before.p - last).Norm();
}

Refusal ArmReach::check(const Eigen::Vector3d& p) noexcept {
  return check_distance((p - origin_).norm());
}

Refusal ArmReach::check_circle(const Eigen::Vector3d& centre, const Eigen::Vector3d& axis,
                               double radius_m) noexcept {
  const Eigen::Vector3d d = centre - origin_;
  const Eigen::Vector3d n = axis.normalized();
  const double in_plane_m = (d - n.dot(d) * n).norm();
  return check_distance(
      std::sqrt(d.squaredNorm() + radius_m * radius_m + 2.0 * radius_m * in_plane_m));
}

Refusal ArmReach::check_distance(double away_m) noexcept {
  if (away_m <= longest_m_ + kRounding_m) return {};
  const auto end = fmt::format_to_n(
      reason_.data(), reason_.size() - 1,
      "the goal is {:.3f} m from the first joint, {:.3f} m beyond the arm's reach of {:.3f} m",
      away_m, away_m - longest_m_, longest_m_);
  *end.out = '\0';
  return {request_answer_t::REFUSED_GOAL_LIMIT, reason_.data()};
}

}  // namespace limber::controller
