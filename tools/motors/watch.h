// A table of what motors measure that are off, again and again. No command, no write.
#pragma once

#include <csignal>
#include <vector>

#include "tools/motors/motor.h"

namespace limber::motor_tools {

/// A head of two lines, then a line a motor.
std::vector<std::string> measured_table(const std::vector<Motor>& motors, Wire* wire, bool fd);

/// Prints until `stop` is not 0: on a terminal the table in its place, else a table a second. None
/// given: all that answer. Throws std::runtime_error if a motor does not answer at first or is on,
/// and as soon as somebody else sends on the bus.
void watch(const BusChoice& bus, std::vector<Motor> motors, const volatile std::sig_atomic_t& stop);

}  // namespace limber::motor_tools
