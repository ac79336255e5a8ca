// The moving bodies of an arm: the KDL chain with everything that is fixed to each other lumped
// together.
#pragma once

#include <Eigen/Core>
#include <kdl/chain.hpp>
#include <vector>

namespace limber::controller {

/// One body and the joint that carries it. The body's frame has its origin on the joint's axis and
/// its z along it; at joint position zero it is the fixed pose (R, p) in the frame of the body
/// before, or of the base.
struct Body {
  bool prismatic = false;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();        ///< m
  double mass = 0.0;                                  ///< kg
  Eigen::Vector3d com = Eigen::Vector3d::Zero();      ///< centre of mass, m
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about the centre of mass, kg m^2
};

struct BodyChain {
  std::vector<Body> bodies;  ///< one a moving joint, base to tip
  Eigen::Matrix3d R_tip;     ///< pose of the tip in the last body's frame
  Eigen::Vector3d p_tip;
};

/// What is fixed to the base is left out. Throws ConfigError for a joint whose position does not
/// count in rad or m, or that has an inertia of its own (rotors are no part of the chain). Set-up
/// only.
BodyChain body_chain(const KDL::Chain& chain);

}  // namespace limber::controller
