// What robot.yaml says, turned into what the driver's cycle works with; and what it refuses to
// start on.
#pragma once

#include <cstddef>
#include <cstdint>

#include "drivers/gate/torque_gate.h"
#include "robots/robot.h"

namespace limber {

/// Throws ConfigError: no drives, too many joints or buses, a session of 0. Set-up only.
void check_robot(const Robot& robot, std::size_t open_buses, std::int64_t session);

/// Share of the wire at robot.rate_hz, 0..1. Throws ConfigError above 90 %. Set-up only.
double checked_bus_load(const Robot& robot, int bus);

/// Limits of the gate at robot.rate_hz.
GateLimits gate_limits(const Robot& robot, std::int64_t session) noexcept;

/// Cycles after which the watchdog of the slowest drive has acted.
int drive_watchdog_cycles_of(const Robot& robot) noexcept;

/// A time in whole cycles, rounded up; at least one.
int cycles_of(double seconds, double rate_hz) noexcept;

}  // namespace limber
