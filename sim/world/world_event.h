// What users may do to the simulated world, checked before it is done.
#pragma once

#include <limber/push_t.hpp>
#include <limber/scenario_event_t.hpp>

#include "sim/model/arm_model.h"
#include "sim/world/push.h"
#include "sim/world/wall.h"

namespace limber::sim {

// False, and nothing written, if a value is not finite or out of range, or a link is unknown.
// Allowed in the cycle.

/// Forces and moments up to 1e4 N and N m each, 0 < duration <= 60 s, both edges within it. Time
/// and the predecessor are left to PushSlots.
[[nodiscard]] bool read_push(const push_t& message, const ArmModel& model, Push* push) noexcept;

/// Stiffness 0 (no wall) to 1e7 N/m, damping up to 1e5 N s/m, points within 100 m, a normal of unit
/// length to 1 %.
[[nodiscard]] bool read_wall(const scenario_event_t& event, Wall* wall) noexcept;

struct Payload {
  double mass = 0.0;
  Eigen::Vector3d p_TL = Eigen::Vector3d::Zero();
};
/// 0 to 100 kg within 1 m of the tip along each axis.
[[nodiscard]] bool read_payload(const scenario_event_t& event, Payload* payload) noexcept;

struct NodeFault {
  int joint = 0;  ///< or NODE_*
  int fault = 0;
  std::int64_t duration_ns = 0;  ///< the largest there is: for ever
};
/// Nodes that can have faults.
struct FaultyNodes {
  int joints = 0;
  bool tip_sensor = false;
  bool emergency_stop = false;
};
/// A FAULT_* on one of the joints, silence of the tip sensor, or an emergency stop that is pressed
/// or silent, for up to 600 s; 0 means for ever.
[[nodiscard]] bool read_fault(const scenario_event_t& event, const FaultyNodes& nodes,
                              NodeFault* fault) noexcept;

}  // namespace limber::sim
