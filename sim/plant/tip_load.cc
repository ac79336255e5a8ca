#include "sim/plant/tip_load.h"

#include <Eigen/Geometry>

namespace limber::sim {
namespace {

Vector6 tip_wrench(const LinkDynamics& arm, const Environment& environment,
                   std::int64_t t_ns) noexcept {
  Vector6 F = environment.contact_wrench(arm);
  for (int i = 0; i < environment.pushes.count(); ++i) {
    if (environment.pushes[i].link == arm.tip()) F += environment.pushes[i].at(t_ns);
  }
  return F;
}

}  // namespace

TipLoad::TipLoad(const TipSensorConfig& sensor, const LinkDynamics& arm)
    : p_TS_(sensor.p_TS),
      R_TS_(Eigen::Quaterniond(sensor.quat_TS[0], sensor.quat_TS[1], sensor.quat_TS[2],
                               sensor.quat_TS[3])
                .toRotationMatrix()) {
  masses_[0].mass = sensor.tool_mass_kg;
  masses_[0].p_T = p_TS_ + R_TS_ * Eigen::Vector3d(sensor.p_SC);
  masses_[0].v = velocity(arm, masses_[0]);
}

void TipLoad::set_payload(const LinkDynamics& arm, double mass,
                          const Eigen::Vector3d& p_T) noexcept {
  masses_[1].mass = mass;
  masses_[1].p_T = p_T;
  masses_[1].v = velocity(arm, masses_[1]);
}

Eigen::Vector3d TipLoad::position(const LinkDynamics& arm, const PointMass& mass) noexcept {
  return arm.link_position(arm.tip()) + arm.link_rotation(arm.tip()) * mass.p_T;
}

Eigen::Vector3d TipLoad::velocity(const LinkDynamics& arm, const PointMass& mass) noexcept {
  return arm.point_velocity(arm.body_of(arm.tip()), position(arm, mass));
}

void TipLoad::step(const LinkDynamics& arm, const Environment& environment, double h,
                   std::int64_t t_ns) noexcept {
  const Eigen::Matrix3d R_BT = arm.link_rotation(arm.tip());
  const Eigen::Vector3d p_S = arm.link_position(arm.tip()) + R_BT * p_TS_;
  const Vector6 contact = tip_wrench(arm, environment, t_ns);
  Eigen::Vector3d f = contact.head<3>();
  Eigen::Vector3d n = contact.tail<3>() - (R_BT * p_TS_).cross(f);
  for (PointMass& mass : masses_) {
    const Eigen::Vector3d v = velocity(arm, mass);
    const Eigen::Vector3d weight = mass.mass * (arm.model().gravity - (v - mass.v) / h);
    mass.v = v;
    f += weight;
    n += (position(arm, mass) - p_S).cross(weight);
  }
  const Eigen::Matrix3d R_SB = (R_BT * R_TS_).transpose();
  F_ << R_SB * f, R_SB * n;
}

}  // namespace limber::sim
