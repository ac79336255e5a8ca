// The five numbers of drivers/protocols/mit.h, in words and in a DBC file.
#pragma once

#include "drivers/protocols/mit.h"
#include "tools/can/dbc.h"
#include "tools/can/reading.h"

namespace limber::bus_tools {

/// "set zero".
const char* special_word(mit::Special special);
std::vector<Value> mit_values(const mit::Command& command);
/// Of a state. Drives truncate: half a count more is what they measured, on average.
std::vector<Value> mit_values(const mit::Reply& reply, const CommandRange& range);

std::vector<dbc::Signal> mit_command_signals(const CommandRange& range);
/// Position, velocity and torque, from the second byte of a state on.
std::vector<dbc::Signal> mit_state_signals(const CommandRange& range);

}  // namespace limber::bus_tools
