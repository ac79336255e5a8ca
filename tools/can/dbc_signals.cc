#include "tools/can/dbc_signals.h"

#include <cmath>

#include "drivers/can/can_frame.h"

namespace limber::bus_tools {

using dbc::Message;
using dbc::Signal;

Message message_of(const Motor& motor, const std::string& what, std::uint32_t id, bool fd,
                   int bytes, bool from_host) {
  Message message;
  message.id = id;
  message.extended = id > kStandardIdMax;
  message.fd = fd;
  message.node = motor.node;
  message.name = message.node + "_" + what;
  message.bytes = bytes;
  message.from_host = from_host;
  return message;
}

void set_full_range(Signal* signal) {
  const double values = std::exp2(signal->bits);
  const double lowest = signal->is_signed ? -values / 2.0 : 0.0;
  signal->low = signal->offset + signal->scale * lowest;
  signal->high = signal->offset + signal->scale * (lowest + values - 1.0);
}

Signal plain(const char* name, int start, int bits, bool motorola, const char* unit) {
  Signal signal{name, start, bits, motorola};
  signal.unit = unit;
  set_full_range(&signal);
  return signal;
}

Motor all_nodes() {
  Motor all;
  all.name = all.node = kAllNodes;
  return all;
}

}  // namespace limber::bus_tools
