#include "controller/elastic/joint_elasticity.h"

namespace limber::controller {

JointElasticity::JointElasticity(const Robot& robot, const JointSprings& springs)
    : K_J(springs.at_rest()), D_J(robot.size()), period_s(1.0 / robot.rate_hz) {
  for (Eigen::Index i = 0; i < D_J.size(); ++i) {
    D_J[i] = robot.joints[static_cast<std::size_t>(i)].transmission.damping_Nms_per_rad;
  }
}

}  // namespace limber::controller
