#include "sim/world/world_event.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limber::sim {
namespace {

constexpr double kMaxForce = 1e4;
constexpr double kMaxPush_s = 60.0;
constexpr double kMaxStiffness = 1e7;
constexpr double kMaxDamping = 1e5;
constexpr double kMaxDistance_m = 100.0;
constexpr double kMaxPayload_kg = 100.0;
constexpr double kMaxPayloadDistance_m = 1.0;
constexpr double kMaxFault_s = 600.0;

// Written so that NaN is outside.
bool within(double value, double low, double high) { return value >= low && value <= high; }

template <std::size_t N>
bool all_within(const double (&values)[N], double limit) {
  return std::all_of(values, values + N, [limit](double x) { return within(x, -limit, limit); });
}

std::int64_t to_ns(double seconds) { return std::llround(seconds * 1e9); }

/// Index of the link, the tip for an empty name, -1 if unknown.
int find_link(const ArmModel& model, const std::string& name) {
  const int last = static_cast<int>(model.links.size()) - 1;
  if (name.empty()) return last;
  for (int i = last; i >= 0; --i) {
    if (model.links[i] == name) return i;
  }
  return -1;
}

}  // namespace

bool read_push(const push_t& message, const ArmModel& model, Push* push) noexcept {
  const int link = find_link(model, message.link);
  if (link < 0 || !all_within(message.wrench, kMaxForce) ||
      !within(message.duration_s, 1e-9, kMaxPush_s) ||
      !within(message.ramp_s, 0.0, 0.5 * message.duration_s)) {
    return false;
  }
  push->id = message.id;
  push->link = link;
  push->wrench = Eigen::Map<const Vector6>(message.wrench);
  push->ramp_ns = to_ns(message.ramp_s);
  push->duration_ns = to_ns(message.duration_s);
  return true;
}

bool read_wall(const scenario_event_t& event, Wall* wall) noexcept {
  const Eigen::Vector3d normal = Eigen::Map<const Eigen::Vector3d>(event.normal);
  if (event.stiffness_N_per_m == 0.0) {
    *wall = Wall();
    return true;
  }
  if (!within(event.stiffness_N_per_m, 0.0, kMaxStiffness) ||
      !within(event.damping_Ns_per_m, 0.0, kMaxDamping) ||
      !all_within(event.point, kMaxDistance_m) || !within(normal.norm(), 0.99, 1.01)) {
    return false;
  }
  *wall = Wall();
  wall->point = Eigen::Map<const Eigen::Vector3d>(event.point);
  wall->normal = normal.normalized();
  wall->stiffness = event.stiffness_N_per_m;
  wall->damping = event.damping_Ns_per_m;
  return true;
}

bool read_payload(const scenario_event_t& event, Payload* payload) noexcept {
  if (!within(event.payload_mass_kg, 0.0, kMaxPayload_kg) ||
      !all_within(event.payload_position, kMaxPayloadDistance_m)) {
    return false;
  }
  *payload = {event.payload_mass_kg, Eigen::Map<const Eigen::Vector3d>(event.payload_position)};
  return true;
}

bool read_fault(const scenario_event_t& event, const FaultyNodes& nodes,
                NodeFault* fault) noexcept {
  using Event = scenario_event_t;
  const bool silent = event.fault == Event::FAULT_SILENT;
  const bool on_sensor = nodes.tip_sensor && event.joint == Event::NODE_TIP_SENSOR && silent;
  const bool on_stop = nodes.emergency_stop && event.joint == Event::NODE_EMERGENCY_STOP &&
                       (silent || event.fault == Event::FAULT_PRESSED);
  const bool of_drive =
      (event.fault >= Event::FAULT_SILENT && event.fault <= Event::FAULT_DROP_COMMANDS) ||
      event.fault == Event::FAULT_HOT;
  const bool on_joint = event.joint >= 0 && event.joint < nodes.joints && of_drive;
  if (!(on_joint || on_sensor || on_stop) || !within(event.duration_s, 0.0, kMaxFault_s))
    return false;
  *fault = {
      event.joint, event.fault,
      event.duration_s > 0.0 ? to_ns(event.duration_s) : std::numeric_limits<std::int64_t>::max()};
  return true;
}

}  // namespace limber::sim
