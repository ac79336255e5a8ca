// An adapter's error frame in words (linux/can/error.h).
#pragma once

#include <vector>

#include "tools/can/reading.h"

namespace limber::bus_tools {

/// What it reports, one value each: "bus-off", "controller: receiver passive", ...
std::vector<Value> error_values(const CanFrame& frame);

}  // namespace limber::bus_tools
