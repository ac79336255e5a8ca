#include "sim/plant/force_model.h"

#include <algorithm>

namespace limber::sim {

ForceModel::ForceModel(const Robot& robot, const Robot& believed, bool friction)
    : size_(robot.size()),
      link_friction_(VectorJ::Zero(size_)),
      stop_torque_(VectorJ::Zero(size_)),
      tau_(VectorJ::Zero(size_)),
      inertia_(VectorJ::Zero(size_)),
      qdd_(VectorJ::Zero(size_)),
      v_guess_(VectorJ::Zero(size_)),
      v_end_(VectorJ::Zero(size_)) {
  for (int i = 0; i < size_; ++i) {
    const JointConfig& joint = robot.joints[i];
    if (friction) {
      friction_[i] = LugreFriction(joint.link_friction, joint.drive.rotor_inertia_kgm2);
    }
    has_bristle_ = has_bristle_ || friction_[i].has_bristle();
    stops_[i] = EndStop(joint);
    first_motor_[i] = motor_count_;
    for (int number = 0; number < joint.motors(); ++number) {
      const JointConfig& known = believed.joints[i];
      const DriveConfig& drive = number == 0 ? known.drive : known.antagonist;
      joint_of_[motor_count_] = i;
      motors_[motor_count_++] = Motor(joint, number, drive.torque_constant_Nm_per_A, friction);
      has_bristle_ = has_bristle_ || motors_[motor_count_ - 1].has_bristle();
    }
  }
  theta_dot_guess_ = theta_dot_end_ = theta_ddot_ = VectorM::Zero(motor_count_);
}

void ForceModel::set_stands_left(double left) noexcept {
  for (Stand& stand : stands) stand.set_left(left);
  for (Motor& motor : motors_) motor.stand.set_left(left);
}

void ForceModel::soften_contacts(LinkDynamics* arm, double h) noexcept {
  if (environment.workpiece.there()) {  // the trace is at least the largest of all directions
    environment.workpiece.limit_to(arm->tip_mobility(Eigen::Vector3d::UnitX()) +
                                       arm->tip_mobility(Eigen::Vector3d::UnitY()) +
                                       arm->tip_mobility(Eigen::Vector3d::UnitZ()),
                                   h);
  }
  constexpr double kNear_m = 0.01;
  Wall& wall = environment.wall;
  if (!(wall.stiffness > 0.0) || wall.depth(arm->link_position(arm->tip())) < -kNear_m) return;
  wall.limit_to(arm->tip_mobility(wall.normal), h);
}

bool ForceModel::passive(const ArmState& x) const noexcept {
  for (int k = 0; k < motor_count_; ++k) {
    if (motors_[k].passive()) return true;
  }
  for (int i = 0; i < size_; ++i) {
    if (friction_[i].any() || stops_[i].touched(x.q[i]) || stands[i].holds()) return true;
  }
  return false;
}

void ForceModel::begin_couplings(const ArmState& x, double h) noexcept {
  for (int k = 0; k < motor_count_; ++k) active_[k] = motors_[k].active(point(x, k), h);
}

void ForceModel::couple_passive(const ArmState& x, double h) noexcept {
  for (int i = 0; i < size_; ++i) {
    const AffineForce friction = friction_[i].step_force(v_guess_[i]);
    const double slope = friction.slope + stopped_[i].slope;
    tau_[i] = -(friction.offset + stopped_[i].offset) - slope * x.v[i];
    inertia_[i] = h * slope;
  }
  for (int k = 0; k < motor_count_; ++k) {
    couplings_[k] = motors_[k].couple(active_[k], point(x, k), theta_dot_guess_[k], h);
    tau_[joint_of_[k]] += couplings_[k].link_torque();
    inertia_[joint_of_[k]] += couplings_[k].link_inertia();
  }
}

void ForceModel::begin_step(LinkDynamics* arm, const ArmState& x, double h,
                            std::int64_t t_ns) noexcept {
  t_ns_ = t_ns;
  soften_contacts(arm, h);
  for (int k = 0; k < motor_count_; ++k) motors_[k].begin_step(drives[k], point(x, k), h);
  const bool held_before = passive_;
  passive_ = passive(x);
  if (passive_) {
    settle(arm, x, h);
  } else if (held_before) {
    let_go();
  }
}

void ForceModel::settle(LinkDynamics* arm, const ArmState& x, double h) noexcept {
  constexpr int kIterations = 3;
  apply_environment(arm);
  begin_couplings(x, h);
  for (int i = 0; i < size_; ++i) {
    friction_[i].begin_step(x.v[i], h);
    const AffineForce stop = stops_[i].step_force(x.q[i], h);
    const AffineForce stand = stands[i].step_force(x.q[i], h);
    stopped_[i] = {stop.offset + stand.offset, stop.slope + stand.slope};
  }
  v_end_ = x.v;
  theta_dot_end_ = x.theta_dot;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    v_guess_ = v_end_;
    theta_dot_guess_ = theta_dot_end_;
    couple_passive(x, h);
    arm->accelerations(tau_, inertia_, &qdd_);
    motor_accelerations(qdd_, &theta_ddot_);
    v_end_ = x.v + h * qdd_;
    theta_dot_end_ = x.theta_dot + h * theta_ddot_;
    if (!has_bristle_) break;  // no force depends on the guess
  }
  finish_step(x, h);
}

void ForceModel::let_go() noexcept {
  link_friction_.setZero();
  stop_torque_.setZero();
  for (int k = 0; k < motor_count_; ++k) motors_[k].let_go();
}

void ForceModel::finish_step(const ArmState& x, double h) noexcept {
  for (int i = 0; i < size_; ++i) {
    link_friction_[i] = -friction_[i].finish_step(v_guess_[i], v_end_[i]);
    stop_torque_[i] =
        stops_[i].torque(x.q[i], v_end_[i], h) + stands[i].torque(x.q[i], v_end_[i], h);
  }
  for (int k = 0; k < motor_count_; ++k) {
    motors_[k].finish_step(point(x, k), theta_dot_guess_[k], theta_dot_end_[k], h);
  }
}

void ForceModel::evaluate(LinkDynamics* arm, const ArmState& x, ArmTorque* tau,
                          Work* power) const noexcept {
  *power = {};
  power->external = apply_environment(arm) + stop_torque_.dot(x.v);
  power->friction = link_friction_.dot(x.v);
  tau->link = link_friction_ + stop_torque_;
  for (int k = 0; k < motor_count_; ++k) {
    const Motor& motor = motors_[k];
    const MotorPoint at = point(x, k);
    const double drive = motor.torque(at);
    const double net = drive + motor.friction_torque() + motor.stand_torque();
    power->motor += drive * at.theta_dot;
    power->friction += motor.friction_torque() * at.theta_dot;
    power->external += motor.stand_torque() * at.theta_dot;
    if (motor.rigid()) {
      tau->link[joint_of_[k]] += net;
      tau->motor[k] = 0.0;
    } else {
      const double transmitted = motor.transmitted(at);
      tau->link[joint_of_[k]] += motor.side() * transmitted;
      tau->motor[k] = net - transmitted;
      power->friction -= motor.damper_power(at, transmitted);
    }
  }
}

void ForceModel::couple(const ArmState& x, double h, VectorJ* tau, VectorJ* inertia) noexcept {
  if (!passive_) begin_couplings(x, h);
  *tau = link_friction_ + stop_torque_;
  inertia->setZero();
  for (int k = 0; k < motor_count_; ++k) {
    couplings_[k] = motors_[k].held(active_[k]);
    (*tau)[joint_of_[k]] += couplings_[k].link_torque();
    (*inertia)[joint_of_[k]] += couplings_[k].link_inertia();
  }
}

void ForceModel::motor_accelerations(const VectorJ& qdd, VectorM* out) const noexcept {
  for (int k = 0; k < motor_count_; ++k) {
    (*out)[k] = couplings_[k].acceleration(qdd[joint_of_[k]]);
  }
}

Work ForceModel::step_power(const ArmState& x, const VectorM& theta_ddot) const noexcept {
  Work power;
  power.external = stop_torque_.dot(x.v);
  power.friction = link_friction_.dot(x.v);
  for (int k = 0; k < motor_count_; ++k) {
    const Motor& motor = motors_[k];
    const MotorPoint at = point(x, k);
    power.motor += (active_[k].drive - active_[k].servo * theta_ddot[k]) * x.theta_dot[k];
    power.friction += motor.friction_torque() * x.theta_dot[k];
    if (!motor.rigid()) power.friction -= motor.damper_power(at, motor.transmitted(at));
    power.external += motor.stand_torque() * x.theta_dot[k];
  }
  return power;
}

VectorJ ForceModel::friction_torque() const noexcept {
  VectorJ out = link_friction_;
  for (int k = 0; k < motor_count_; ++k) {
    out[joint_of_[k]] += motors_[k].side() * motors_[k].friction_torque();
  }
  return out;
}

double ForceModel::bristle_energy() const noexcept {
  double energy = 0.0;
  for (const LugreFriction& friction : friction_) energy += friction.bristle_energy();
  for (const Motor& motor : motors_) energy += motor.bristle_energy();
  return energy;
}

double ForceModel::elastic_energy(const ArmState& x) const noexcept {
  double energy = 0.0;
  for (int k = 0; k < motor_count_; ++k) energy += motors_[k].elastic_energy(point(x, k));
  return energy;
}

double ForceModel::spring_torque(const ArmState& x, int joint) const noexcept {
  double torque = 0.0;
  for (int k = first_motor(joint); k < end_motor(joint); ++k) {
    torque += motors_[k].side() * motors_[k].spring_torque(point(x, k));
  }
  return torque;
}

double ForceModel::joint_torque(const ArmState& x, int joint) const noexcept {
  double torque = 0.0;
  for (int k = first_motor(joint); k < end_motor(joint); ++k) {
    torque += motors_[k].side() * motors_[k].torque_behind(point(x, k));
  }
  return torque;
}

double ForceModel::joint_stiffness(const ArmState& x, int joint) const noexcept {
  double stiffness = 0.0;
  for (int k = first_motor(joint); k < end_motor(joint); ++k) {
    stiffness += motors_[k].stiffness(point(x, k));
  }
  return stiffness;
}

}  // namespace limber::sim
