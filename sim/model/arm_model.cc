#include "sim/model/arm_model.h"

namespace limber::sim {
namespace {

void add_motors(const JointConfig& joint, int i, ArmModel* model) {
  if (joint.rigid()) {
    model->rotor_inertia[i] = joint.drive.rotor_inertia_kgm2;
    model->motors.push_back({i, 1.0, true, 0.0});
    return;
  }
  model->motors.push_back({i, 1.0, false, joint.drive.rotor_inertia_kgm2});
  if (joint.has_antagonist) {
    model->motors.push_back({i, -1.0, false, joint.antagonist.rotor_inertia_kgm2});
  }
}

}  // namespace

ArmModel build_arm_model(const LoadedRobot& robot) {
  const int joints = robot.robot.size();
  ArmModel model;
  model.chain = dynamics::body_chain(robot.chain, joints);
  model.links = robot.segment_links;
  for (std::size_t i = model.links.size(); i < model.chain.frames.size(); ++i)
    model.links.push_back(robot.chain.segments[i].getName());
  model.rotor_inertia = VectorJ::Zero(joints);
  for (int i = 0; i < joints; ++i) add_motors(robot.robot.joints[i], i, &model);
  model.gravity = Eigen::Map<const Eigen::Vector3d>(robot.robot.gravity);
  return model;
}

}  // namespace limber::sim
