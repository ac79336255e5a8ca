// The moving bodies of an arm: the KDL chain with everything that is fixed to each other lumped
// together.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace KDL {
class Chain;
}

#pragma GCC visibility push(default)
namespace limber::dynamics {

/// Mass, centre of mass and inertia about the centre of mass, all in one frame. kg, m, kg m^2.
struct MassProperties {
  double mass = 0.0;
  Eigen::Vector3d com = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
};

/// `body` with a point mass fixed to it at `position`. Allowed in the cycle.
MassProperties with_point_mass(const MassProperties& body, double mass,
                               const Eigen::Vector3d& position) noexcept;

/// One body and the joint that carries it. The body's frame has its origin on the joint's axis and
/// its z along it; at joint position zero it is the fixed pose (R, p) in the frame of the body
/// before, or of the base.
struct Body {
  bool prismatic = false;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  ///< m
  MassProperties mass{};

  /// Of the body alone about its joint's axis (its mass on a slider): never more than what the
  /// joint moves.
  double own_inertia() const noexcept;
};

/// A frame fixed to a body, at (R, p) in the body's frame.
struct FixedFrame {
  int body = -1;  ///< -1: the base
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
};

struct BodyChain {
  std::vector<Body> bodies;        ///< one a moving joint, base to tip
  std::vector<FixedFrame> frames;  ///< ends of the chain's segments; the last one is the tip

  int size() const noexcept { return static_cast<int>(bodies.size()); }
};

/// The mass of what is fixed to the base is left out. Throws ConfigError if the chain has another
/// number of moving joints than `joints`, none or more than kMaxJoints, or a joint whose position
/// does not count in rad or m or that has an inertia of its own (rotors are no part of the chain).
/// Set-up only.
BodyChain body_chain(const KDL::Chain& chain, int joints);

}  // namespace limber::dynamics
#pragma GCC visibility pop
