// The moving bodies of a serial arm: the KDL chain with everything that is fixed to each other
// lumped together.
#pragma once

#include <Eigen/Core>
#include <kdl/chain.hpp>
#include <string>
#include <vector>

#include "robots/loader/load_robot.h"

namespace limber::sim {

/// Mass, centre of mass and inertia about the centre of mass, all in one frame. kg, m, kg m^2.
struct MassProperties {
  double mass = 0.0;
  Eigen::Vector3d com = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
};

/// `body` with a point mass fixed to it at `position`.
MassProperties with_point_mass(const MassProperties& body, double mass,
                               const Eigen::Vector3d& position) noexcept;

/// One moving body and the joint that carries it. The body frame sits on the joint axis and moves
/// with the body; at joint position zero it is the fixed pose (R_PJ, p_PJ) in the frame of the body
/// before (or the base).
struct BodyModel {
  bool prismatic = false;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< body frame, unit length
  Eigen::Matrix3d R_PJ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p_PJ = Eigen::Vector3d::Zero();
  MassProperties mass;
  double rotor_inertia = 0.0;  ///< reflected (B): adds to the diagonal of M and to nothing else;
                               ///< zero where the motor is behind a spring
};

/// Inertia of the body alone about its joint's axis (its mass on a slider): never more than what
/// the joint moves.
double own_inertia(const BodyModel& body) noexcept;

/// One motor.
struct MotorModel {
  int joint = 0;
  double side = 1.0;     ///< -1: the antagonist, which counts the other way than its joint
  bool rigid = true;     ///< the rotor is part of the link
  double inertia = 0.0;  ///< B of a motor behind a spring
};

/// A named frame fixed to a body.
struct LinkModel {
  std::string name;
  int body = -1;  ///< -1: the base
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
};

struct ArmModel {
  std::vector<BodyModel> bodies;   ///< one a moving joint, base to tip
  std::vector<MotorModel> motors;  ///< in the order of the joints, one or two each
  std::vector<LinkModel>
      links;  ///< one a segment of the chain, base to tip; the last one is the tip
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  ///< base axes, m/s^2

  int size() const { return static_cast<int>(bodies.size()); }
};

/// Builds the model of a loaded robot. Throws ConfigError for more than kMaxJoints joints, or when
/// the chain's moving joints and the robot's joints differ in number. Set-up only.
ArmModel build_arm_model(const LoadedRobot& robot);

}  // namespace limber::sim
