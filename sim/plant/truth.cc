#include "sim/plant/truth.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace limber::sim {
namespace {

void copy(const Vector6& from, double* to) { std::copy_n(from.data(), 6, to); }

/// Of two motors half the difference and half the sum, and the difference of their torques.
void fill_motors(const ForceModel& forces, const ArmState& x, int joint, sim_truth_t* truth) {
  const int first = forces.first_motor(joint);
  const int end = forces.end_motor(joint);
  double equilibrium = 0.0;
  double speed = 0.0;
  double torque = 0.0;
  double hottest = forces.motor(first).winding_degC();
  for (int k = first; k < end; ++k) {
    const Motor& motor = forces.motor(k);
    equilibrium += motor.side() * x.theta[k];
    speed += motor.side() * x.theta_dot[k];
    torque += motor.side() * motor.torque(forces.point(x, k));
    hottest = std::max(hottest, motor.winding_degC());
  }
  const int count = end - first;
  truth->theta[joint] = equilibrium / count;
  truth->theta_dot[joint] = speed / count;
  truth->preload[joint] =
      count == 2 ? static_cast<float>(0.5 * (x.theta[first] + x.theta[first + 1])) : 0.0F;
  truth->tau_motor[joint] = static_cast<float>(torque);
  truth->winding_degC[joint] = static_cast<float>(hottest);
}

void fill_joints(const ArmPlant& plant, const ForceModel& forces, const VectorJ& external,
                 sim_truth_t* truth) {
  const ArmState& x = plant.state();
  const VectorJ friction = forces.friction_torque();
  for (int i = 0; i < plant.arm().size(); ++i) {
    truth->q[i] = x.q[i];
    truth->v[i] = x.v[i];
    truth->tau_joint[i] = static_cast<float>(forces.joint_torque(x, i));
    truth->sigma[i] = static_cast<float>(forces.joint_stiffness(x, i));
    truth->tau_friction[i] = static_cast<float>(friction[i]);
    truth->tau_external[i] = static_cast<float>(external[i] + forces.stop_torque()[i]);
    fill_motors(forces, x, i, truth);
  }
}

void fill_tip(const LinkDynamics& arm, sim_truth_t* truth) {
  const int tip = arm.tip();
  const Eigen::Vector3d p = arm.link_position(tip);
  const Eigen::Quaterniond Q(arm.link_rotation(tip));
  std::copy_n(p.data(), 3, truth->p_BT);
  truth->quat_BT[0] = Q.w();
  truth->quat_BT[1] = Q.x();
  truth->quat_BT[2] = Q.y();
  truth->quat_BT[3] = Q.z();
  Vector6 V;
  V << arm.link_velocity(tip), arm.link_angular_velocity(tip);
  copy(V, truth->V_BT);
}

}  // namespace

void fill_truth(const ForceModel& forces, std::int64_t t_ns, ArmPlant* at,
                sim_truth_t* truth) noexcept {
  const ArmPlant& plant = *at;
  const Environment& environment = forces.environment;
  const Vector6 contact = environment.contact_wrench(plant.arm());
  const VectorJ& external = at->external_torque(environment, t_ns);
  truth->num_joints = static_cast<std::int8_t>(plant.arm().size());
  truth->contact = contact.isZero(0.0) ? 0 : 1;
  fill_joints(plant, forces, external, truth);
  fill_tip(plant.arm(), truth);
  copy(contact, truth->F_contact);
  copy(environment.push_wrench(plant.arm(), t_ns), truth->F_push);
  truth->kinetic_energy_J = plant.kinetic_energy();
  truth->potential_energy_J = plant.arm().potential_energy();
  truth->elastic_energy_J = forces.elastic_energy(plant.state());
  truth->work_motor_J = plant.work().motor;
  truth->work_external_J = plant.work().external;
  truth->work_friction_J = -plant.work().friction;
}

}  // namespace limber::sim
