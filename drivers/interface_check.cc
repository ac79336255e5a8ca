#include "drivers/interface_check.h"

#include <fmt/format.h>

#include <cmath>

namespace limber {
namespace {

constexpr double kRatesAgree = 0.005;
constexpr std::uint32_t kQueue = 64;  // frames: more than a cycle of the largest arm

bool agree(std::uint32_t found, int expected) {
  return std::abs(static_cast<double>(found) - expected) <= kRatesAgree * expected;
}

const char* name_of(CanControllerState state) {
  switch (state) {
    case CanControllerState::kErrorActive:
      return "error-active";
    case CanControllerState::kErrorWarning:
      return "error-warning";
    case CanControllerState::kErrorPassive:
      return "error-passive";
    case CanControllerState::kBusOff:
      return "bus-off";
    case CanControllerState::kStopped:
      return "stopped";
    case CanControllerState::kSleeping:
      break;
  }
  return "sleeping";
}

void compare_rates(const BusConfig& bus, const LinkDetails& link, std::vector<std::string>* wrong) {
  if (!agree(link.bitrate, bus.bitrate_bps))
    wrong->push_back(fmt::format("bit rate {}, robot.yaml has {}", link.bitrate, bus.bitrate_bps));
  if (!bus.fd) return;
  if (!link.fd) {
    wrong->emplace_back("CAN-FD is off, robot.yaml has fd: true");
  } else if (!agree(link.data_bitrate, bus.data_bitrate_bps)) {
    wrong->push_back(fmt::format("data bit rate {}, robot.yaml has {}", link.data_bitrate,
                                 bus.data_bitrate_bps));
  }
}

}  // namespace

InterfaceFindings compare(const BusConfig& bus, const LinkDetails& link) {
  InterfaceFindings found;
  if (!link.has_bit_timing()) return found;
  if (link.queue_frames < kQueue)
    found.doubtful.push_back(
        fmt::format("its transmit queue holds {} frames: txqueuelen {} takes a cycle of any arm",
                    link.queue_frames, kQueue));
  compare_rates(bus, link, &found.wrong);
  if (link.restart_ms == 0)
    found.doubtful.emplace_back("restart-ms is 0: a bus-off lasts until somebody restarts it");
  const std::string state = fmt::format(
      "its controller is {}: check wiring, termination and bit "
      "rate",
      name_of(link.state));
  if (link.state == CanControllerState::kErrorWarning ||
      link.state == CanControllerState::kErrorPassive) {
    found.doubtful.push_back(state);
  } else if (link.state != CanControllerState::kErrorActive) {
    found.wrong.push_back(state);
  }
  return found;
}

}  // namespace limber
