// M, g and the tip pose of a loaded arm, for tests.
#pragma once

#include <Eigen/Core>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <vector>

#include "robots/loader/load_robot.h"

namespace limber::testing {

struct Terms {
  Eigen::MatrixXd M;
  Eigen::VectorXd g;
  Eigen::Vector3d p_BT;
  Eigen::Matrix3d R_BT;
};

inline Terms terms_at(const LoadedRobot& robot, const std::vector<double>& pose) {
  const auto n = static_cast<unsigned>(robot.robot.size());
  KDL::JntArray q(n);
  for (unsigned i = 0; i < n; ++i) q(i) = pose.at(i);
  const auto& gravity = robot.robot.gravity;
  KDL::ChainDynParam dynamics(robot.chain, KDL::Vector(gravity[0], gravity[1], gravity[2]));
  KDL::JntSpaceInertiaMatrix M(n);
  KDL::JntArray g(n);
  dynamics.JntToMass(q, M);
  dynamics.JntToGravity(q, g);
  KDL::Frame X_BT;
  KDL::ChainFkSolverPos_recursive(robot.chain).JntToCart(q, X_BT);
  Terms terms{M.data, g.data, {X_BT.p.x(), X_BT.p.y(), X_BT.p.z()}, Eigen::Matrix3d()};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) terms.R_BT(i, j) = X_BT.M(i, j);
  }
  return terms;
}

}  // namespace limber::testing
