#include "drivers/driver_setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/config_error.h"
#include "drivers/bus_load.h"
#include "drivers/drive/motor_view.h"

namespace limber {
namespace {

constexpr double kLease_s = 0.25;
constexpr double kRefusals_s = 0.1;
constexpr double kPowerSlack = 1.25;
constexpr double kRoundingSlack = 1e-9;  // a step of exactly the limit may differ in its last bits

}  // namespace

int cycles_of(double seconds, double rate_hz) noexcept {
  return std::max(1, static_cast<int>(std::ceil(seconds * rate_hz - 1e-6)));
}

int drive_watchdog_cycles_of(const Robot& robot) {
  double longest_s = 0.0;
  for (const JointConfig& joint : robot.driven()) {
    for (int motor = 0; motor < joint.motors(); ++motor)
      longest_s = std::max(longest_s, joint.motor(motor).watchdog_s);
  }
  return cycles_of(longest_s, robot.rate_hz);
}

void check_robot(const Robot& robot, std::size_t open_buses, std::int64_t session) {
  const auto refuse = [&](const std::string& key, const std::string& problem) {
    throw ConfigError::at(robot.name, 0, key, problem);
  };
  if (!robot.has_drives) refuse("drives", "none are described; a bare URDF cannot be driven");
  const int most = robot.hand ? kMaxJoints - 1 : kMaxJoints;
  if (robot.joints.empty() || robot.size() > most)
    refuse("joints", fmt::format("{} found, 1 to {} allowed", robot.size(), most));
  if (robot.buses.empty() || robot.buses.size() > kMaxBuses || robot.buses.size() != open_buses)
    refuse("buses", fmt::format("{} described, {} open, 1 to {} allowed", robot.buses.size(),
                                open_buses, kMaxBuses));
  if (robot.has_tip_sensor && robot.tip_sensor.bus >= static_cast<int>(robot.buses.size()))
    refuse("tip_sensor.bus", "does not exist");
  if (!(robot.rate_hz > 0.0)) refuse("rate_hz", "must be positive");
  if (session == 0) refuse("session", "0 names no session");
}

std::int64_t reply_window_ns_of(const Robot& robot) noexcept {
  return std::llround(1e9 * reply_window_s(robot));
}

std::int64_t least_round_trip_ns_of(const Robot& robot) noexcept {
  double least_s = 1.0;
  for (int bus = 0; bus < static_cast<int>(robot.buses.size()); ++bus) {
    const double bus_s = least_round_trip_s(robot, bus);
    if (bus_s > 0.0) least_s = std::min(least_s, bus_s);
  }
  return std::llround(1e9 * least_s);
}

GateLimits gate_limits(const Robot& robot, std::int64_t session) {
  GateLimits limits;
  const std::vector<JointConfig> driven = robot.driven();
  limits.n = static_cast<int>(driven.size());
  limits.hand = robot.hand ? 1 : 0;
  limits.session = session;
  limits.lease_cycles = cycles_of(kLease_s, robot.rate_hz);
  // The controller shapes at the limit itself; a noisy velocity must not trip the arm.
  limits.power_W = kPowerSlack * robot.power_limit_W;
  limits.refusal_cycles = cycles_of(kRefusals_s, robot.rate_hz);
  for (std::size_t i = 0; i < driven.size(); ++i) {
    const JointConfig& joint = driven[i];
    limits.torque_Nm[i] = std::min(joint.torque_limit_Nm, joint.drive.range.torque_Nm);
    limits.torque_step_Nm[i] =
        joint.torque_rate_limit_Nm_per_s / robot.rate_hz * (1.0 + kRoundingSlack);
    if (!joint.has_antagonist) continue;
    limits.preload_Nm[i] =
        2.0 * std::min(pulling_limit(joint.drive), pulling_limit(joint.antagonist));
    limits.preload_step_Nm[i] = 2.0 * limits.torque_step_Nm[i];
  }
  return limits;
}

}  // namespace limber
