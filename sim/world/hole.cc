#include "sim/world/hole.h"

#include <Eigen/Geometry>
#include <cmath>

namespace limber::sim {
namespace {

using Flat = Eigen::Vector2d;  // (rho, z)

/// Vector to `p` from the nearest point of the segment between a and b; a ray where b is far.
Flat from_segment(const Flat& p, const Flat& a, const Flat& b) {
  const Flat along = b - a;
  const double length2 = along.squaredNorm();
  const double share = length2 > 0.0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return p - (a + share * along);
}

}  // namespace

Touches Hole::touches(const Eigen::Vector3d& p, double ball_radius) const noexcept {
  constexpr double kFar_m = 1e3;
  const Eigen::Vector3d from_mouth = p - mouth;
  const double z = normal.dot(from_mouth);
  const Eigen::Vector3d across = from_mouth - z * normal;
  const double rho = across.norm();
  const Eigen::Vector3d outwards =
      rho > 0.0 ? Eigen::Vector3d(across / rho) : normal.unitOrthogonal();
  const Flat at(rho, z);
  // Distances from face, bore and chamfer, each with its normal out of the plate.
  const Flat normals[3] = {{0.0, 1.0}, {-1.0, 0.0}, Flat(-1.0, 1.0).normalized()};
  const double distances[3] = {z, radius - rho, (radius + chamfer - rho + z) / std::sqrt(2.0)};
  int least = 0;
  for (int i = 1; i < 3; ++i) {
    if (distances[i] > distances[least]) least = i;
  }
  Flat away = normals[least];
  double distance = distances[least];
  if (distance > 0.0) {  // the ball's centre is outside of the plate
    const Flat edges[3] = {from_segment(at, {radius + chamfer, 0.0}, {kFar_m, 0.0}),
                           from_segment(at, {radius, -chamfer}, {radius, -kFar_m}),
                           from_segment(at, {radius + chamfer, 0.0}, {radius, -chamfer})};
    const Flat* nearest = &edges[0];
    for (const Flat& edge : edges) {
      if (edge.squaredNorm() < nearest->squaredNorm()) nearest = &edge;
    }
    distance = nearest->norm();
    if (distance > 0.0) away = *nearest / distance;
  }
  const Touch plate{away.x() * outwards + away.y() * normal, ball_radius - distance};
  const Touch floor{normal, rho < radius ? ball_radius - (z + depth) : 0.0};
  return {plate, floor};
}

}  // namespace limber::sim
