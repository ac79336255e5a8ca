#include "sim/plant/ode_plant.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/config_error.h"

namespace limber::sim {
namespace {

void start_ode_once() {
  static const int started = dInitODE2(0);
  if (started == 0) throw ConfigError("the physics engine ODE could not be initialised");
}

/// The same refusal ODE would make by aborting, in words.
void require_mass(const ArmModel& model) {
  for (int i = 0; i < model.chain.size(); ++i) {
    const dynamics::MassProperties& mass = model.chain.bodies[i].mass;
    const Eigen::Vector3d moments = mass.inertia.selfadjointView<Eigen::Lower>().eigenvalues();
    if (mass.mass > 0.0 && moments.minCoeff() > 0.0) continue;
    throw ConfigError(
        fmt::format("the link moved by joint {} has mass {} kg and a smallest moment of inertia of "
                    "{} kg m^2, and ODE "
                    "needs both above 0; use integrator: reference",
                    i + 1, mass.mass, moments.minCoeff()));
  }
}

/// ODE's 3x4 row-major rotation.
void to_ode(const Eigen::Matrix3d& R, dMatrix3 out) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out[4 * row + column] = R(row, column);
    out[4 * row + 3] = 0.0;
  }
}

void set_mass(dBodyID body, const dynamics::MassProperties& mass) {
  const Eigen::Matrix3d& I = mass.inertia;
  dMass out;
  dMassSetParameters(&out, mass.mass, 0.0, 0.0, 0.0, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2),
                     I(1, 2));
  dBodySetMass(body, &out);
}

Eigen::Vector3d to_eigen(const dReal* v) { return {v[0], v[1], v[2]}; }

/// dJointGetSliderPositionRate() takes the difference of the bodies' velocities and forgets that
/// the carrying body turns.
double slider_rate(dBodyID body, dBodyID parent, dJointID slider) {
  dVector3 axis;
  dJointGetSliderAxis(slider, axis);
  Eigen::Vector3d v = to_eigen(dBodyGetLinearVel(body));
  if (parent != nullptr) {
    const Eigen::Vector3d between =
        to_eigen(dBodyGetPosition(body)) - to_eigen(dBodyGetPosition(parent));
    v -= to_eigen(dBodyGetLinearVel(parent)) + to_eigen(dBodyGetAngularVel(parent)).cross(between);
  }
  return to_eigen(axis).dot(v);
}

}  // namespace

OdePlant::OdePlant(const ArmModel& model)
    : ArmPlant(model),
      tau_(VectorJ::Zero(model.chain.size())),
      qdd_(VectorJ::Zero(model.chain.size())),
      extra_inertia_(VectorJ::Zero(model.chain.size())),
      theta_ddot_(VectorM::Zero(x_.theta.size())) {
  require_mass(model);
  start_ode_once();
  world_ = dWorldCreate();
  threading_ = dThreadingAllocateSelfThreadedImplementation();
  dWorldSetStepThreadingImplementation(world_, dThreadingImplementationGetFunctions(threading_),
                                       threading_);
  joints_ = dJointGroupCreate(0);
  dWorldSetCFM(world_,
               0.0);  // a serial chain has no redundant constraints that would need softening
  dWorldSetGravity(world_, model.gravity.x(), model.gravity.y(), model.gravity.z());
  for (int i = 0; i < model.chain.size(); ++i) create(i);
  assemble();
  dWorldStep(world_, 1e-6);  // allocates ODE's working memory; the next step finds it
  state_was_set();
}

OdePlant::~OdePlant() {
  dJointGroupDestroy(joints_);
  dWorldDestroy(world_);
  dThreadingFreeImplementation(threading_);
}

void OdePlant::create(int i) {
  body_[i] = dBodyCreate(world_);
  const dBodyID parent = i > 0 ? body_[i - 1] : nullptr;
  joint_[i] =
      arm_.prismatic(i) ? dJointCreateSlider(world_, joints_) : dJointCreateHinge(world_, joints_);
  dJointAttach(joint_[i], body_[i], parent);
}

void OdePlant::assemble() noexcept {
  // ODE takes the posture in which a joint's anchor and axis are set as its zero.
  arm_.set_state(VectorJ::Zero(arm_.size()), VectorJ::Zero(arm_.size()));
  place_bodies(arm_);
  for (int i = 0; i < arm_.size(); ++i) {
    set_mass(body_[i], arm_.mass(i));
    const Eigen::Vector3d p = arm_.body_position(i);
    const Eigen::Vector3d z = arm_.joint_axis(i);
    if (arm_.prismatic(i)) {
      dJointSetSliderAxis(joint_[i], z.x(), z.y(), z.z());
    } else {
      dJointSetHingeAnchor(joint_[i], p.x(), p.y(), p.z());
      dJointSetHingeAxis(joint_[i], z.x(), z.y(), z.z());
    }
  }
  arm_.set_state(x_.q, x_.v);
  place_bodies(arm_);
}

void OdePlant::place_bodies(const LinkDynamics& arm) noexcept {
  for (int i = 0; i < arm.size(); ++i) {
    // ODE's body frame must sit at the centre of mass.
    const Eigen::Vector3d p = arm.centre_of_mass(i);
    const Eigen::Vector3d v = arm.point_velocity(i, p);
    const Eigen::Vector3d w = arm.angular_velocity(i);
    dMatrix3 rotation;
    to_ode(arm.body_rotation(i), rotation);
    dBodySetPosition(body_[i], p.x(), p.y(), p.z());
    dBodySetRotation(body_[i], rotation);
    dBodySetLinearVel(body_[i], v.x(), v.y(), v.z());
    dBodySetAngularVel(body_[i], w.x(), w.y(), w.z());
  }
}

void OdePlant::state_was_set() noexcept { place_bodies(arm_); }

void OdePlant::payload_was_set() noexcept { assemble(); }

void OdePlant::integrate(ForceModel* forces, double h) noexcept {
  const double contact_power = forces->apply_environment(&arm_);
  forces->couple(x_, h, &tau_, &extra_inertia_);
  arm_.accelerations(tau_, extra_inertia_, &qdd_);
  if (!tau_.allFinite() || !qdd_.allFinite()) {
    x_.v.setConstant(
        std::numeric_limits<double>::quiet_NaN());  // ODE would abort; step() will not take this
    return;
  }
  apply(tau_);
  dWorldStep(world_, h);
  read_joints();
  forces->motor_accelerations(qdd_, &theta_ddot_);
  x_.theta_dot += h * theta_ddot_;
  x_.theta += h * x_.theta_dot;
  carry_rotors();
  // Forces of the step act along the motion of the step, which is at its end velocity.
  arm_.set_state(x_.q, x_.v);
  const Work power = forces->step_power(x_, theta_ddot_);
  work_.motor += h * power.motor;
  work_.friction += h * power.friction;
  work_.external +=
      h * power.external + 0.5 * h * (contact_power + forces->apply_environment(&arm_));
}

void OdePlant::apply(const VectorJ& tau) noexcept {
  for (int i = 0; i < arm_.size(); ++i) {
    const double torque = tau[i] - (arm_.model().rotor_inertia[i] + extra_inertia_[i]) * qdd_[i];
    if (arm_.prismatic(i)) {
      dJointAddSliderForce(joint_[i], torque);
    } else {
      dJointAddHingeTorque(joint_[i], torque);
    }
    const Vector6& F = arm_.external_wrench(i);
    dBodyAddForceAtPos(body_[i], F[0], F[1], F[2], 0.0, 0.0, 0.0);
    dBodyAddTorque(body_[i], F[3], F[4], F[5]);
  }
}

void OdePlant::read_joints() noexcept {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  for (int i = 0; i < arm_.size(); ++i) {
    if (arm_.prismatic(i)) {
      x_.q[i] = dJointGetSliderPosition(joint_[i]);
      x_.v[i] = slider_rate(body_[i], i > 0 ? body_[i - 1] : nullptr, joint_[i]);
    } else {
      // ODE's angle lies in +-pi; the turn nearest to the last angle is meant.
      const double angle = dJointGetHingeAngle(joint_[i]);
      x_.q[i] = angle + kTurn * std::round((x_.q[i] - angle) / kTurn);
      x_.v[i] = dJointGetHingeAngleRate(joint_[i]);
    }
  }
}

}  // namespace limber::sim
