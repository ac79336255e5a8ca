#include "sim/force_model.h"

namespace limber::sim {

ForceModel::ForceModel(const Robot& robot, bool friction)
    : size_(robot.size()),
      friction_torque_(VectorJ::Zero(size_)),
      stop_torque_(VectorJ::Zero(size_)),
      tau_(VectorJ::Zero(size_)),
      slope_(VectorJ::Zero(size_)),
      qdd_(VectorJ::Zero(size_)),
      v_guess_(VectorJ::Zero(size_)),
      v_end_(VectorJ::Zero(size_)) {
  for (int i = 0; i < size_; ++i) {
    const JointConfig& joint = robot.joints[i];
    if (friction) friction_[i] = LugreFriction(joint.friction, joint.drive.rotor_inertia_kgm2);
    stops_[i] = EndStop(joint);
  }
}

AffineForce ForceModel::passive_force(int joint, double q, double v, double v_guess,
                                      double h) const noexcept {
  const AffineForce friction = friction_[joint].step_force(v, v_guess, h);
  const AffineForce stop = stops_[joint].step_force(q, h);
  const AffineForce stand = stands[joint].step_force(q, h);
  return {friction.offset + stop.offset + stand.offset,
          friction.slope + stop.slope + stand.slope + drives[joint].passive_damping};
}

void ForceModel::soften_wall(ArticulatedBody* arm, double h) noexcept {
  constexpr double kNear_m = 0.01;
  Wall& wall = environment.wall;
  if (!(wall.stiffness > 0.0) || wall.depth(arm->link_position(arm->tip())) < -kNear_m) return;
  wall.limit_to(arm->tip_mobility(wall.normal), h);
}

void ForceModel::begin_step(ArticulatedBody* arm, const VectorJ& q, const VectorJ& v, double h,
                            std::int64_t t_ns) noexcept {
  constexpr int kIterations = 3;
  t_ns_ = t_ns;
  soften_wall(arm, h);
  apply_environment(arm);
  v_end_ = v;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    bool passive = false;
    v_guess_ = v_end_;
    for (int i = 0; i < size_; ++i) {
      const AffineForce force = passive_force(i, q[i], v[i], v_guess_[i], h);
      tau_[i] = drives[i].torque(q[i], v[i]) - force.offset - force.slope * v[i];
      slope_[i] = h * force.slope;
      passive = passive || force.offset != 0.0 || force.slope != 0.0;
    }
    if (!passive) break;
    arm->accelerations(tau_, slope_, &qdd_);
    v_end_ = v + h * qdd_;
  }
  for (int i = 0; i < size_; ++i) {
    friction_torque_[i] = -friction_[i].finish_step(v[i], v_guess_[i], v_end_[i], h) -
                          drives[i].passive_damping * v_end_[i];
    stop_torque_[i] = stops_[i].torque(q[i], v_end_[i], h) + stands[i].torque(q[i], v_end_[i], h);
  }
}

void ForceModel::evaluate(ArticulatedBody* arm, const VectorJ& q, const VectorJ& v, VectorJ* tau,
                          Work* power) const noexcept {
  *power = {};
  power->external = apply_environment(arm);
  for (int i = 0; i < size_; ++i) {
    const double motor = drives[i].torque(q[i], v[i]);
    (*tau)[i] = motor + friction_torque_[i] + stop_torque_[i];
    power->motor += motor * v[i];
    power->friction += friction_torque_[i] * v[i];
    power->external += stop_torque_[i] * v[i];
  }
}

double ForceModel::bristle_energy() const noexcept {
  double energy = 0.0;
  for (const LugreFriction& friction : friction_) energy += friction.bristle_energy();
  return energy;
}

}  // namespace limber::sim
