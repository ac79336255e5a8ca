#include "sim/plant/start_state.h"

namespace limber::sim {

void start_at(const Robot& robot, const VectorJ& q, bool stand, ArmPlant* plant) {
  plant->set_state(q, VectorJ::Zero(q.size()));
  const VectorJ g = plant->arm().gravity_torque();
  ArmState x = plant->state();
  int motor = 0;
  for (int i = 0; i < robot.size(); motor += robot.joints[i].motors(), ++i) {
    const TransmissionConfig& config = robot.joints[i].transmission;
    const Transmission transmission(config);
    if (config.kind == TransmissionKind::kAntagonistic) {
      const double ahead = transmission.deflection(g[i], config.preload_rad);
      x.theta[motor] = config.preload_rad + q[i] + ahead;
      x.theta[motor + 1] = config.preload_rad - q[i] - ahead;
    } else if (!stand) {
      x.theta[motor] = q[i] + transmission.deflection(g[i], 0.0);
    }
  }
  plant->set_state(x);
}

void set_stands(const Robot& robot, const ArmState& x, ForceModel* forces) noexcept {
  for (int i = 0; i < robot.size(); ++i) forces->stands[i] = Stand(robot.joints[i], x.q[i]);
  for (int k = 0; k < forces->motors(); ++k) {
    const JointConfig& joint = robot.joints[forces->joint_of(k)];
    if (joint.has_antagonist) forces->set_motor_stand(k, Stand(joint, x.theta[k]));
  }
}

}  // namespace limber::sim
