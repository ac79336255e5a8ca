// A ball at the tip against a smooth surface: Kelvin and Voigt along the normal
// (common/contact_law.h), Coulomb across it.
//
//   F = F_n n - min(mu F_n / max(|v_t|, v_0), b_max) v_t
//
// v_0 = 1 mm/s: slower than that, friction is a damper, and what should stick creeps.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <limits>

#include "common/contact_law.h"

namespace limber::sim {

/// Where a ball touches, base axes; `depth` > 0 inside, m.
struct Touch {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< out of the surface, unit length
  double depth = 0.0;
};
using Touches = std::array<Touch, 2>;  ///< at most so many of one ball

/// Allowed in the cycle.
struct ContactMaterial {
  static constexpr double kSlowest_m_per_s = 1e-3;

  double stiffness = 0.0;  ///< N/m
  double damping = 0.0;    ///< N s/m
  double friction = 0.0;   ///< mu
  double max_stiffness = std::numeric_limits<double>::infinity();
  double max_damping = std::numeric_limits<double>::infinity();

  /// As Wall::limit_to(), for a mobility (1/kg) of the two bodies together.
  void limit_to(double mobility, double h) noexcept {
    max_stiffness = 1.0 / (h * h * mobility);
    max_damping = 0.5 / (h * mobility);
  }

  /// On the ball whose touching point moves with v against the surface.
  Eigen::Vector3d force(const Touch& at, const Eigen::Vector3d& v) const noexcept {
    const Approach approach(-at.depth * at.normal, v, Eigen::Vector3d::Zero(), at.normal);
    const double push =
        kelvin_voigt(approach, std::min(stiffness, max_stiffness), std::min(damping, max_damping));
    const Eigen::Vector3d sliding = v - at.normal.dot(v) * at.normal;
    const double drag = friction * push / std::max(sliding.norm(), kSlowest_m_per_s);
    return push * at.normal - std::min(drag, max_damping) * sliding;
  }
};

}  // namespace limber::sim
