// Before the first cycle: is every motor there? Costs nothing that a motor would notice.
#pragma once

#include <csignal>
#include <span>
#include <string>

#include "drivers/can/can_bus.h"
#include "robots/robot.h"

namespace limber {

/// Asks every motor for something it can read out, ten times a second, until all have answered;
/// that moves, enables and disturbs nothing. Returns "" then, or after `patience_s` (or when `stop`
/// is set) the motors that are missing, for a message. Set-up only.
std::string call_roll(const Robot& robot, std::span<CanBus* const> buses, double patience_s,
                      const volatile std::sig_atomic_t& stop);

}  // namespace limber
