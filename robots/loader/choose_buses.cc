#include "robots/loader/choose_buses.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/can_address.h"
#include "common/config_error.h"
#include "robots/loader/adapter.h"

namespace limber {

void choose_buses(const std::map<std::string, std::string>& addresses, Robot* robot) {
  std::string names;
  for (const BusConfig& bus : robot->buses) names += (names.empty() ? "" : ", ") + bus.name;
  for (const auto& [name, address] : addresses) {
    const auto bus = std::ranges::find(robot->buses, name, &BusConfig::name);
    if (bus == robot->buses.end())
      throw ConfigError(fmt::format("--bus {}={}: {} has no bus '{}'; it has: {}", name, address,
                                    robot->name, name, names));
    bus->can = address;
    bus->adapter = adapter_of(address, bus->adapter);
  }
}

void require_simulated_buses(const std::map<std::string, std::string>& addresses,
                             const Robot& robot) {
  for (const BusConfig& bus : robot.buses) {
    if (addresses.contains(bus.name) || is_virtual(bus.can)) continue;
    throw ConfigError(fmt::format(
        "bus {} is {}, which may carry a real arm: run it without the simulator (limber "
        "run --no-sim), or say where to simulate with --bus {}=ADDRESS",
        bus.name, bus.can, bus.name));
  }
}

}  // namespace limber
