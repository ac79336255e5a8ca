// Things that a hand can take: where they are, and whether the hand's friction carries them.
//
// An object is between the fingers from when the grasp point is within kReach_m of it, and they are
// open wider than it, until that is further away and does not hold it. There both fingers press it
// with F and can carry 2 mu F:
//
//   held      2 mu F >= c m |a - g|  it moves with the tip, and c times its mass is the arm's
//   slipping  else                   m v' = m g + 2 mu F (towards the tip's velocity)
//   free      F = 0                  m v' = m g, down to the height at which it lay; there it rests
//
// a is the tip's acceleration at the object, over 5 ms. All of m (a - g) counts, as if it were
// tangential to the fingers whatever their direction: the worst case. The height is along gravity.
// c goes from 0 to 1 over the first kLift_m above the height at which it lay: what it lies on gives
// way like a spring, but carries no more than its weight.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "scenarios/loader/object_config.h"
#include "sim/model/link_dynamics.h"

namespace limber::sim {

/// After construction every member is allowed in the cycle.
class Objects {
 public:
  static constexpr double kReach_m = 0.03;
  static constexpr double kLift_m = 2e-3;

  /// At most kMostObjects; grasp point in tip axes, m; gravity in base axes, m/s^2.
  Objects(const std::vector<ObjectConfig>& objects, const double p_TG[3], const double gravity[3]);
  /// As at the start.
  void reset() noexcept;

  /// After a step of h seconds: the tip is that of `arm`, the fingers are `width` apart and press
  /// what is between them with `force`.
  void step(const LinkDynamics& arm, double width, double force, double h) noexcept;

  static constexpr int kNone = -1;
  int between() const noexcept { return between_; }
  int held() const noexcept { return held_ ? between_ : kNone; }
  /// Of the object held, what the arm carries: kg; 0 if there is none.
  double held_mass_kg() const noexcept;
  /// Of the object held, in tip axes.
  const Eigen::Vector3d& held_at() const noexcept { return p_TO_; }
  std::size_t count() const noexcept { return count_; }
  const ObjectConfig& config(std::size_t i) const noexcept { return configs_[i]; }
  const Eigen::Vector3d& position(std::size_t i) const noexcept { return states_[i].p; }
  bool rests(std::size_t i) const noexcept { return states_[i].rests; }
  bool slips(std::size_t i) const noexcept { return states_[i].slips; }

 private:
  struct State {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    Eigen::Vector3d v = Eigen::Vector3d::Zero();
    bool rests = true;
    bool slips = false;
  };
  void find_between(const Eigen::Vector3d& grasp_point, double width) noexcept;
  void carry(const LinkDynamics& arm, double force, double h) noexcept;
  void hold(const LinkDynamics& arm) noexcept;
  void fall(std::size_t i, double h) noexcept;
  double depth(std::size_t i) const noexcept;
  double carried_share(std::size_t i) const noexcept;

  std::array<ObjectConfig, kMostObjects> configs_;
  std::array<State, kMostObjects> states_;
  std::size_t count_;
  Eigen::Vector3d p_TG_;
  Eigen::Vector3d gravity_;
  Eigen::Vector3d down_;
  int between_ = kNone;
  bool held_ = false;
  Eigen::Vector3d p_TO_ = Eigen::Vector3d::Zero();
  bool moved_ = false;  ///< the two below are of a step before
  Eigen::Vector3d v_tip_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d a_tip_ = Eigen::Vector3d::Zero();
};

}  // namespace limber::sim
