// What the DBC messages of all families are made of.
#pragma once

#include <string>

#include "tools/can/dbc.h"
#include "tools/can/motors_on_bus.h"

namespace limber::bus_tools {

dbc::Message message_of(const Motor& motor, const std::string& what, std::uint32_t id, bool fd,
                        int bytes, bool from_host);
/// The lowest and highest value that an integer's bits can carry.
void set_full_range(dbc::Signal* signal);
/// An integer.
dbc::Signal plain(const char* name, int start, int bits, bool motorola, const char* unit = "");
/// Receiver of frames that are meant for all.
Motor all_nodes();
inline constexpr const char* kAllNodes = "all";

}  // namespace limber::bus_tools
