// Forces of a contact between a point and a plane, by two models.
//
//   Kelvin and Voigt:  F = max(0, k delta - b v_n) n
//   Hunt and Crossley (ASME J. Appl. Mech. 42, 1975):  F = max(0, k delta^1.5 (1 - c v_n)) n
//
// for delta > 0, else none; delta = -n . (p - p0), v_n = n . v. The second starts from zero however
// fast the point arrives.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace limber {

/// How a point stands to a plane with unit normal towards free space.
struct Approach {
  double depth;  ///< delta, m: positive inside
  double speed;  ///< v_n, m/s: positive outwards

  Approach(const Eigen::Vector3d& p, const Eigen::Vector3d& v, const Eigen::Vector3d& p0,
           const Eigen::Vector3d& n) noexcept
      : depth(-n.dot(p - p0)), speed(n.dot(v)) {}
};

/// Force along the normal, N; k in N/m, b in N s/m. May be called in the cycle.
inline double kelvin_voigt(const Approach& at, double k, double b) noexcept {
  const double push = at.depth > 0.0 ? k * at.depth - b * at.speed : 0.0;
  return push > 0.0 ? push : 0.0;
}

/// Force along the normal, N; k in N/m^1.5, c in s/m. May be called in the cycle.
inline double hunt_crossley(const Approach& at, double k, double c) noexcept {
  const double push =
      at.depth > 0.0 ? k * at.depth * std::sqrt(at.depth) * (1.0 - c * at.speed) : 0.0;
  return push > 0.0 ? push : 0.0;
}

}  // namespace limber
