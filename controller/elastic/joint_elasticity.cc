#include "controller/elastic/joint_elasticity.h"

namespace limber::controller {

JointElasticity::JointElasticity(const Robot& robot, const JointSprings& springs)
    : K_J(springs.at_rest()),
      D_J(robot.size()),
      period_s(1.0 / robot.rate_hz),
      designed_for(springs.any()) {
  for (Eigen::Index i = 0; i < D_J.size(); ++i) {
    const JointConfig& joint = robot.joints[static_cast<std::size_t>(i)];
    D_J[i] = joint.transmission.damping_Nms_per_rad;
    if (joint.has_antagonist) designed_for = false;
  }
}

}  // namespace limber::controller
