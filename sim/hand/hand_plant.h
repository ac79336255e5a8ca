// The simulated hand with what lies within its reach.
#pragma once

#include <Eigen/Core>
#include <limber/hand_truth_t.hpp>

#include "sim/hand/fingers.h"
#include "sim/hand/objects.h"

namespace limber::sim {

/// A point mass that the hand hangs on the tip; none of 0 kg.
struct HeldMass {
  double mass_kg = 0.0;
  Eigen::Vector3d p_T = Eigen::Vector3d::Zero();
};

/// After construction every member is allowed in the cycle.
class HandPlant {
 public:
  HandPlant(const HandConfig& hand, double believed_torque_constant, bool friction,
            const std::vector<ObjectConfig>& objects, const double gravity[3])
      : fingers_(hand, believed_torque_constant, friction), objects_(objects, hand.p_TG, gravity) {}

  /// `law`: of the drive; `arm`: at the end of the step of h seconds.
  void step(const DriveLaw& law, const LinkDynamics& arm, double h) noexcept;
  void reset_objects() noexcept { objects_.reset(); }

  const Fingers& fingers() const noexcept { return fingers_; }
  const Objects& objects() const noexcept { return objects_; }
  /// What the arm carries of it.
  HeldMass held() const noexcept { return {objects_.held_mass_kg(), objects_.held_at()}; }
  /// All but seq and time.
  void fill(hand_truth_t* truth) const noexcept;

 private:
  Fingers fingers_;
  Objects objects_;
};

}  // namespace limber::sim
