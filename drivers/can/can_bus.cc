#include "drivers/can/can_bus.h"

#include <algorithm>
#include <array>

#include "common/can_address.h"
#include "common/config_error.h"
#include "common/joints.h"
#include "common/shared_memory/spin.h"
#include "common/wait_readable.h"
#include "drivers/can/serial_bus.h"
#include "drivers/can/shared_bus.h"
#include "drivers/can/socketcan.h"
#include "drivers/can/virtual_bus.h"

namespace limber {

std::unique_ptr<CanBus> open_can_bus(const std::string& address, bool fd, Stamps stamps,
                                     int bitrate_bps) {
  const std::optional<CanAddress> found = can_address(address);
  if (!found)
    throw ConfigError("CAN bus '" + address + "': expected " + std::string(kCanAddressForms));
  if (found->serial()) return open_serial_bus(address, *found, fd, bitrate_bps);
  const std::string& name = found->place;
  if (found->carrier == CanCarrier::kSocketCan) return open_socketcan(name, fd);
  const auto shared = shared_bus_options();
  return shared ? open_shared_bus(name, fd, stamps, *shared) : open_virtual_bus(name, fd, stamps);
}

std::string bus_text(const std::string& address) {
  const bool shared = is_virtual(address) && shared_bus_options().has_value();
  return shared ? address + " in shared memory" : address;
}

bool wait_readable(std::span<CanBus* const> buses, std::int64_t deadline_ns,
                   int other_descriptor) noexcept {
  const auto arrived = [buses] { return std::ranges::any_of(buses, &CanBus::something_waits); };
  if (std::ranges::any_of(buses, &CanBus::polls) && spin_until(deadline_ns, arrived)) return true;
  std::array<int, kMaxBuses + 1> descriptors{other_descriptor};
  std::size_t count = 1;
  for (CanBus* bus : buses) {
    bus->about_to_sleep();
    if (count < descriptors.size()) descriptors[count++] = bus->descriptor();
  }
  // Behind about_to_sleep(): what comes from here on wakes.
  return arrived() || wait_readable(std::span<const int>(descriptors.data(), count), deadline_ns);
}

}  // namespace limber
