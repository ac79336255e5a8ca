#include "tools/can/replay.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "common/clock.h"
#include "common/config_error.h"
#include "common/wait_readable.h"
#include "drivers/can/can_bus.h"
#include "tools/can/bus_decoder.h"
#include "tools/can/frame_source.h"

namespace limber::bus_tools {
namespace {

struct Planned {
  std::int64_t time_ns;
  int bus;
  CanFrame frame;
};

void require_virtual_buses(const Robot& robot, bool force) {
  std::string real;
  for (const BusConfig& bus : robot.buses) {
    if (!is_virtual(bus.can)) real += (real.empty() ? "" : ", ") + bus.can;
  }
  if (real.empty()) return;
  if (!force)
    throw ConfigError(
        fmt::format("{} may carry a real arm, and what is sent there may move it; choose a virtual "
                    "bus with --bus {}=virtual:NAME, or add --force",
                    real, robot.buses.front().name));
  spdlog::warn("sending to {}: whatever is on the bus will move", real);
}

/// Everything of the file that is to be sent.
std::vector<Planned> read_plan(const Robot& robot, const ReplayOptions& options,
                               ReplayCount* count) {
  std::vector<BusDecoder> decoders;
  for (int bus = 0; bus < static_cast<int>(robot.buses.size()); ++bus)
    decoders.emplace_back(robot, bus);
  const auto wanted = [&](const Reading& reading) {
    if (reading.direction == Direction::kError) return false;
    if (options.only.empty()) return true;
    return reading.direction ==
           (options.only == "commands" ? Direction::kCommand : Direction::kReply);
  };
  std::vector<Planned> plan;
  FrameSource source;
  source.file = options.file;
  const auto losses =
      each_frame(robot, source, [&](std::int64_t time_ns, int bus, const CanFrame& frame) {
        if (wanted(decoders[static_cast<std::size_t>(bus)].read(frame)))
          plan.push_back({time_ns, bus, frame});
        else
          ++count->left_out;
        return true;
      });
  for (const auto& [interface, frames] : losses.elsewhere) count->left_out += frames;
  return plan;
}

/// False if stopped.
bool sleep_until(std::int64_t time_ns, const volatile std::sig_atomic_t& stop) {
  while (stop == 0 && monotonic_ns() < time_ns) wait_readable(std::span<const int>(), time_ns);
  return stop == 0;
}

}  // namespace

ReplayCount replay(const Robot& robot, const ReplayOptions& options,
                   const volatile std::sig_atomic_t& stop) {
  require_virtual_buses(robot, options.force);
  ReplayCount count;
  const std::vector<Planned> plan = read_plan(robot, options, &count);
  std::vector<std::unique_ptr<CanBus>> buses;
  for (const BusConfig& bus : robot.buses) buses.push_back(open_bus(bus));
  std::int64_t due_ns = monotonic_ns();
  std::int64_t last_ns = plan.empty() ? 0 : plan.front().time_ns;
  for (const Planned& planned : plan) {
    due_ns += std::max<std::int64_t>(0, planned.time_ns - last_ns);
    last_ns = planned.time_ns;
    if (!sleep_until(due_ns, stop)) break;
    if (buses[static_cast<std::size_t>(planned.bus)]->send(planned.frame) == 1)
      ++count.sent;
    else
      ++count.refused;
  }
  return count;
}

}  // namespace limber::bus_tools
