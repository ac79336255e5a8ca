#include "sim/world/environment.h"

#include <Eigen/Geometry>

namespace limber::sim {

TipMotion tip_motion(const LinkDynamics& arm) noexcept {
  const int tip = arm.tip();
  return {arm.link_position(tip), arm.link_velocity(tip), arm.link_angular_velocity(tip),
          arm.link_rotation(tip)};
}

double Environment::apply(LinkDynamics* arm, std::int64_t t_ns) const noexcept {
  arm->clear_wrenches();
  double power = 0.0;
  if (wall.stiffness > 0.0) {
    const int tip = arm->tip();
    const Eigen::Vector3d p_tip = arm->link_position(tip);
    const Eigen::Vector3d v_tip = arm->link_velocity(tip);
    const Eigen::Vector3d contact = wall.force(p_tip, v_tip);
    arm->add_wrench(arm->body_of(tip), p_tip, contact, Eigen::Vector3d::Zero());
    power += contact.dot(v_tip);
  }
  if (workpiece.there()) {
    const TipMotion tip = tip_motion(*arm);
    const Vector6 F = workpiece.wrench(tip);
    arm->add_wrench(arm->body_of(arm->tip()), tip.p, F.head<3>(), F.tail<3>());
    power += F.head<3>().dot(tip.v) + F.tail<3>().dot(tip.w);
  }
  for (int i = 0; i < pushes.count(); ++i) {
    const int link = pushes[i].link;
    const Vector6 F = pushes[i].at(t_ns);
    arm->add_wrench(arm->body_of(link), arm->link_position(link), F.head<3>(), F.tail<3>());
    power += F.head<3>().dot(arm->link_velocity(link)) +
             F.tail<3>().dot(arm->link_angular_velocity(link));
  }
  return power;
}

Vector6 Environment::contact_wrench(const LinkDynamics& arm) const noexcept {
  Vector6 F = workpiece.wrench(tip_motion(arm));
  F.head<3>() += wall.force(arm.link_position(arm.tip()), arm.link_velocity(arm.tip()));
  return F;
}

Vector6 Environment::push_wrench(const LinkDynamics& arm, std::int64_t t_ns) const noexcept {
  Vector6 sum = Vector6::Zero();
  const Eigen::Vector3d p_tip = arm.link_position(arm.tip());
  for (int i = 0; i < pushes.count(); ++i) {
    Vector6 F = pushes[i].at(t_ns);
    F.tail<3>() += (arm.link_position(pushes[i].link) - p_tip).cross(F.head<3>());
    sum += F;
  }
  return sum;
}

}  // namespace limber::sim
