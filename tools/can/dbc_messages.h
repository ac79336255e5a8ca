// The frames that limber and the drives and sensors of one bus exchange, as DBC messages.
#pragma once

#include <vector>

#include "robots/loader/robot.h"
#include "tools/can/dbc.h"

namespace limber::bus_tools {

std::vector<dbc::Message> dbc_messages(const Robot& robot, int bus);

}  // namespace limber::bus_tools
