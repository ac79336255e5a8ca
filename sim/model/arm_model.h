// The simulated arm as it is: moving bodies, motors, names of links.
#pragma once

#include <string>
#include <vector>

#include "common/types.h"
#include "dynamics/body_chain.h"
#include "robots/loader/load_robot.h"

namespace limber::sim {

/// One motor.
struct MotorModel {
  int joint = 0;
  double side = 1.0;     ///< -1: the antagonist, which counts the other way than its joint
  bool rigid = true;     ///< the rotor is part of the link
  double inertia = 0.0;  ///< B of a motor behind a spring
};

struct ArmModel {
  dynamics::BodyChain chain;
  std::vector<std::string> links;  ///< names of the chain's frames; the last one is the tip
  VectorJ rotor_inertia;  ///< reflected (B): adds to the diagonal of M and to nothing else;
                          ///< zero where the motor is behind a spring
  std::vector<MotorModel> motors;  ///< in the order of the joints, one or two each
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  ///< base axes, m/s^2
};

/// Builds the model of a loaded robot. Throws ConfigError as body_chain() does. Set-up only.
ArmModel build_arm_model(const LoadedRobot& robot);

}  // namespace limber::sim
