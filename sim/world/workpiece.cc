#include "sim/world/workpiece.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace limber::sim {
namespace {

// Written so that NaN is outside.
bool in_range(double value, double low, double high) { return value >= low && value <= high; }

bool all_in_range(const double (&values)[3], double low, double high) {
  return std::all_of(values, values + 3, [&](double x) { return in_range(x, low, high); });
}

Eigen::Vector3d three(const double (&values)[3]) { return Eigen::Vector3d(values); }

bool contact_is_valid(const workpiece_t& message) {
  return all_in_range(message.point, -100.0, 100.0) &&
         in_range(three(message.normal).norm(), 0.99, 1.01) &&
         in_range(message.tip_radius_m, 0.0, 1.0) && all_in_range(message.peg, -1.0, 1.0) &&
         in_range(message.stiffness_N_per_m, 1.0, 1e7) &&
         in_range(message.damping_Ns_per_m, 0.0, 1e5) && in_range(message.friction, 0.0, 2.0);
}

bool hole_is_valid(const workpiece_t& message) {
  return in_range(message.radius_m, 1e-4, 1.0) && message.radius_m > message.tip_radius_m &&
         in_range(message.chamfer_m, 0.0, 1.0) && in_range(message.depth_m, message.chamfer_m, 1.0);
}

bool block_is_valid(const workpiece_t& message) {
  return all_in_range(message.size, 1e-3, 10.0) && in_range(message.yaw, -100.0, 100.0) &&
         in_range(message.mass_kg, 1e-3, 1000.0) && in_range(message.table_friction, 0.0, 2.0);
}

}  // namespace

Eigen::Vector3d Workpiece::force_at(const TipMotion& tip, const Eigen::Vector3d& ball,
                                    const Touch& touch) const noexcept {
  if (!(touch.depth > 0.0)) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d point = ball - tip_radius_ * touch.normal;
  Eigen::Vector3d v = tip.v + tip.w.cross(point - tip.p);
  if (block() != nullptr) v -= block()->velocity_at(point);
  return material_.force(touch, v);
}

Vector6 Workpiece::wrench(const TipMotion& tip) const noexcept {
  Vector6 F = Vector6::Zero();
  const auto add = [&](const Eigen::Vector3d& ball, const Touch& touch) {
    const Eigen::Vector3d force = force_at(tip, ball, touch);
    F.head<3>() += force;
    F.tail<3>() += (ball - tip_radius_ * touch.normal - tip.p).cross(force);
  };
  if (block() != nullptr) add(tip.p, block()->touch(tip.p, tip_radius_));
  if (const auto* hole = std::get_if<Hole>(&shape_)) {
    for (const Touch& touch : hole->touches(tip.p, tip_radius_)) add(tip.p, touch);
    if (!peg_.isZero(0.0)) {
      const Eigen::Vector3d end = tip.p + tip.R * peg_;
      for (const Touch& touch : hole->touches(end, tip_radius_)) add(end, touch);
    }
  }
  return F;
}

void Workpiece::limit_to(double mobility, double h) noexcept {
  material_.limit_to(mobility + (block() != nullptr ? block()->mobility() : 0.0), h);
}

void Workpiece::advance(const TipMotion& tip, double h) noexcept {
  auto* moving = std::get_if<Block>(&shape_);
  if (moving == nullptr) return;
  const Touch touch = moving->touch(tip.p, tip_radius_);
  moving->advance(-force_at(tip, tip.p, touch), tip.p - tip_radius_ * touch.normal, h);
}

bool read_workpiece(const workpiece_t& message, const Eigen::Vector3d& gravity,
                    Workpiece* workpiece) noexcept {
  if (message.kind == workpiece_t::KIND_NONE) {
    *workpiece = Workpiece();
    return true;
  }
  if (!contact_is_valid(message)) return false;
  Workpiece read;
  const Eigen::Vector3d normal = three(message.normal).normalized();
  if (message.kind == workpiece_t::KIND_HOLE && hole_is_valid(message)) {
    read.shape_ =
        Hole{three(message.point), normal, message.radius_m, message.chamfer_m, message.depth_m};
    read.peg_ = three(message.peg);
  } else if (message.kind == workpiece_t::KIND_BLOCK && block_is_valid(message)) {
    read.shape_ = Block(three(message.point), normal, message.yaw, three(message.size),
                        message.mass_kg, message.table_friction, gravity);
  } else {
    return false;
  }
  read.material_.stiffness = message.stiffness_N_per_m;
  read.material_.damping = message.damping_Ns_per_m;
  read.material_.friction = message.friction;
  read.tip_radius_ = message.tip_radius_m;
  *workpiece = read;
  return true;
}

}  // namespace limber::sim
