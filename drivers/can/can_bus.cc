#include "drivers/can/can_bus.h"

#include <array>

#include "common/config_error.h"
#include "common/joints.h"
#include "common/wait_readable.h"
#include "drivers/can/socketcan.h"
#include "drivers/can/virtual_bus.h"

namespace limber {

std::unique_ptr<CanBus> open_can_bus(const std::string& address, bool fd, Stamps stamps) {
  const auto colon = address.find(':');
  const std::string kind = address.substr(0, colon);
  const std::string name = colon == std::string::npos ? "" : address.substr(colon + 1);
  if (kind == "socketcan" && !name.empty()) return open_socketcan(name, fd);
  if (kind == "virtual" && !name.empty()) return open_virtual_bus(name, fd, stamps);
  throw ConfigError(
      "CAN bus '" + address +
      "': expected socketcan:INTERFACE (socketcan:can0) or virtual:NAME (virtual:default)");
}

bool wait_readable(std::span<CanBus* const> buses, std::int64_t deadline_ns) noexcept {
  std::array<int, kMaxBuses> descriptors{};
  std::size_t count = 0;
  for (const CanBus* bus : buses) {
    if (count < descriptors.size()) descriptors[count++] = bus->descriptor();
  }
  return wait_readable(std::span<const int>(descriptors.data(), count), deadline_ns);
}

}  // namespace limber
