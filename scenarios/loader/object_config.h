// A thing in the simulated world that a hand can grasp.
#pragma once

#include <cstddef>
#include <string>

namespace limber {

/// Most that a scenario may have.
inline constexpr std::size_t kMostObjects = 8;

/// Pressed by both fingers, as a spring and a damper of the width between them; a point mass.
struct ObjectConfig {
  std::string name;
  double p_B[3] = {0.0, 0.0, 0.0};  ///< where it lies, base frame, m
  double width_m = 0.0;
  double stiffness_N_per_m = 0.0;
  double damping_Ns_per_m = 0.0;
  double mass_kg = 0.0;
  double friction = 0.0;  ///< coefficient at each finger
};

}  // namespace limber
