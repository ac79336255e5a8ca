// Which motors are on which bus, for people: identifiers, and how python-can joins.
#pragma once

#include <string>

#include "robots/loader/robot.h"

namespace limber::bus_tools {

/// Throws ConfigError if an address is none.
std::string nodes_text(const Robot& robot);

}  // namespace limber::bus_tools
