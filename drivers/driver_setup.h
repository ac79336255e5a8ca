// Settings of the driver's cycle derived from robot.yaml, and the checks before the first cycle.
#pragma once

#include <cstddef>
#include <cstdint>

#include "drivers/gate/torque_gate.h"
#include "robots/loader/robot.h"

namespace limber {

/// Throws ConfigError: no drives, too many joints or buses, a session of 0. Set-up only.
void check_robot(const Robot& robot, std::size_t open_buses, std::int64_t session);

/// Limits of the gate at robot.rate_hz.
GateLimits gate_limits(const Robot& robot, std::int64_t session);

/// Cycles after which the watchdog of the slowest drive has acted.
int drive_watchdog_cycles_of(const Robot& robot);

/// A time in whole cycles, rounded up; at least one.
int cycles_of(double seconds, double rate_hz) noexcept;

/// See ArmDriver and bus_load.h.
std::int64_t reply_window_ns_of(const Robot& robot) noexcept;
/// Over all buses, ns.
std::int64_t least_round_trip_ns_of(const Robot& robot) noexcept;

}  // namespace limber
