// How far a goal at the tip may be: no farther than the stretched arm.
#pragma once

#include <Eigen/Core>
#include <array>

#include "controller/kinds/refusal.h"
#include "robots/loader/load_robot.h"

namespace limber::controller {

/// A bound that needs no inverse kinematics: the distances from each joint to the next, and the
/// travel of prismatic joints. A goal within it may still be out of reach.
class ArmReach {
 public:
  explicit ArmReach(const LoadedRobot& robot);

  /// Nothing, or by how much a goal at `p` (base frame, m) is beyond the reach. The reason lasts
  /// until the next call. In the cycle.
  Refusal check(const Eigen::Vector3d& p) noexcept;
  /// The same of a circle's farthest point; `axis`: any length but zero.
  Refusal check_circle(const Eigen::Vector3d& centre, const Eigen::Vector3d& axis,
                       double radius_m) noexcept;

  double longest_m() const noexcept { return longest_m_; }
  /// Of the first joint, base frame, m.
  const Eigen::Vector3d& origin() const noexcept { return origin_; }

 private:
  Refusal check_distance(double away_m) noexcept;

  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  double longest_m_ = 0.0;
  std::array<char, 160> reason_{};
};

}  // namespace limber::controller
