// What touches the arm from outside: a wall or a workpiece at the tip, and hands on the links.
#pragma once

#include <cstdint>

#include "sim/model/link_dynamics.h"
#include "sim/world/push.h"
#include "sim/world/wall.h"
#include "sim/world/workpiece.h"

namespace limber::sim {

/// Allowed in the cycle throughout.
struct Environment {
  Wall wall;
  Workpiece workpiece;
  PushSlots pushes;

  /// Adds all wrenches at the arm's present state and simulated time t to the arm; returns their
  /// power, W.
  double apply(LinkDynamics* arm, std::int64_t t_ns) const noexcept;

  // Base axes, reduced to the tip origin.
  Vector6 contact_wrench(const LinkDynamics& arm) const noexcept;  ///< of wall and workpiece
  Vector6 push_wrench(const LinkDynamics& arm, std::int64_t t_ns) const noexcept;
};

TipMotion tip_motion(const LinkDynamics& arm) noexcept;

}  // namespace limber::sim
