// What touches the arm from outside: a wall at the tip and hands on the links.
#pragma once

#include <cstdint>

#include "sim/model/link_dynamics.h"
#include "sim/world/push.h"
#include "sim/world/wall.h"

namespace limber::sim {

/// Allowed in the cycle throughout.
struct Environment {
  Wall wall;
  PushSlots pushes;

  /// Adds all wrenches at the arm's present state and simulated time t to the arm; returns their
  /// power, W.
  double apply(LinkDynamics* arm, std::int64_t t_ns) const noexcept;

  // Base axes, reduced to the tip origin.
  Vector6 wall_wrench(const LinkDynamics& arm) const noexcept;
  Vector6 push_wrench(const LinkDynamics& arm, std::int64_t t_ns) const noexcept;
};

}  // namespace limber::sim
