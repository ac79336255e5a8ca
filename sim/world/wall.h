// A plane the tip can lean on, by Kelvin and Voigt.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>

#include "common/contact_law.h"

namespace limber::sim {

/// Contact of one point, the tip origin; base axes. Without stiffness there is no wall. Allowed in
/// the cycle throughout.
struct Wall {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< towards free space, unit length
  double stiffness = 0.0;                             ///< N/m
  double damping = 0.0;                               ///< N s/m

  // The hardest wall that an explicit step can carry, see limit_to().
  double max_stiffness = std::numeric_limits<double>::infinity();
  double max_damping = std::numeric_limits<double>::infinity();

  /// Keeps k h^2 <= m and b h <= m/2 for a tip that weighs m = 1 / mobility along the normal. A
  /// harder wall would throw the tip back with more than it came with; use a shorter step for it.
  void limit_to(double mobility, double h) noexcept {
    max_stiffness = 1.0 / (h * h * mobility);
    max_damping = 0.5 / (h * mobility);
  }

  double depth(const Eigen::Vector3d& p) const noexcept { return -normal.dot(p - point); }

  /// Force of the wall on the point; zero outside.
  Eigen::Vector3d force(const Eigen::Vector3d& p, const Eigen::Vector3d& v) const noexcept {
    if (!(stiffness > 0.0) || !(depth(p) > 0.0)) return Eigen::Vector3d::Zero();
    const Approach at(p, v, point, normal);
    return kelvin_voigt(at, std::min(stiffness, max_stiffness), std::min(damping, max_damping)) *
           normal;
  }
};

}  // namespace limber::sim
