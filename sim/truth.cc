#include "sim/truth.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace limber::sim {
namespace {

void copy(const Vector6& from, double* to) { std::copy_n(from.data(), 6, to); }

void fill_joints(const ArmPlant& plant, const ForceModel& forces, const VectorJ& external,
                 sim_truth_t* truth) {
  for (int i = 0; i < plant.arm().size(); ++i) {
    const double q = plant.q()[i];
    const double v = plant.v()[i];
    truth->q[i] = q;
    truth->v[i] = v;
    truth->tau_motor[i] = static_cast<float>(forces.drives[i].torque(q, v));
    truth->tau_friction[i] = static_cast<float>(forces.friction_torque()[i]);
    truth->tau_external[i] = static_cast<float>(external[i] + forces.stop_torque()[i]);
  }
}

void fill_tip(const ArticulatedBody& arm, sim_truth_t* truth) {
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
  const Vector6 contact = environment.wall_wrench(plant.arm());
  const VectorJ external = at->external_torque(environment, t_ns);
  truth->num_joints = static_cast<std::int8_t>(plant.arm().size());
  truth->contact = contact.isZero(0.0) ? 0 : 1;
  fill_joints(plant, forces, external, truth);
  fill_tip(plant.arm(), truth);
  copy(contact, truth->F_contact);
  copy(environment.push_wrench(plant.arm(), t_ns), truth->F_push);
  truth->kinetic_energy_J = plant.arm().kinetic_energy();
  truth->potential_energy_J = plant.arm().potential_energy();
  truth->work_motor_J = plant.work().motor;
  truth->work_external_J = plant.work().external;
  truth->work_friction_J = -plant.work().friction;
}

}  // namespace limber::sim
