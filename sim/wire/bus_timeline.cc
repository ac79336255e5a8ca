#include "sim/wire/bus_timeline.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "drivers/can/frame_time.h"
#include "drivers/protocols/canopen.h"
#include "drivers/protocols/cycle_frames.h"
#include "robots/loader/adapter.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "sim/wire/wire.h"

namespace limber::sim {
namespace {

constexpr int kMaster = 0;

std::vector<Exchange> typical_exchanges(const Robot& robot, int bus) {
  std::vector<Exchange> all = cycle_frames(robot, bus);
  std::minstd_rand random;
  for (Exchange& exchange : all) {
    fill_typical(&exchange.command, &random);
    for (CanFrame& reply : exchange.replies) fill_typical(&reply, &random);
  }
  return all;
}

}  // namespace

std::vector<FrameTimes> bus_timeline(const Robot& robot, int bus) {
  const BusConfig& config = robot.buses[static_cast<std::size_t>(bus)];
  const std::vector<Exchange> all = typical_exchanges(robot, bus);
  Wire wire(config, {.on = true}, static_cast<int>(all.size()) + 1, 0);
  const auto start_ns = static_cast<std::int64_t>(1e9 * timing_of(config.adapter).send_s);
  const auto delay_ns = static_cast<std::int64_t>(1e9 * kDriveReplyDelay_s);
  for (const Exchange& exchange : all) {
    wire.send(kMaster, exchange.command, start_ns);
    for (const CanFrame& request : exchange.requests) wire.send(kMaster, request, start_ns);
  }
  const bool sync = std::ranges::any_of(all, &Exchange::at_sync);
  if (sync) wire.send(kMaster, canopen::encode_sync(), start_ns);

  std::vector<FrameTimes> times;
  const auto answer = [&](std::size_t i, std::int64_t end_ns) {
    for (const CanFrame& reply : all[i].replies)
      wire.send(static_cast<int>(i) + 1, reply, end_ns + delay_ns);
  };
  WireEvent event;
  while (wire.next(INT64_MAX, &event)) {
    const double end_s = 1e-9 * static_cast<double>(event.end_ns);
    const double length_s = frame_time_s(event.frame, config.bitrate_bps, config.data_bitrate_bps);
    FrameTimes entry{"SYNC", event.frame.id, event.sender != kMaster, end_s - length_s, end_s};
    for (std::size_t i = 0; i < all.size(); ++i) {
      const bool its_command = event.sender == kMaster && event.frame.id == all[i].command.id;
      if (its_command || event.sender == static_cast<int>(i) + 1) entry.name = all[i].name;
      for (std::size_t k = 0; k < all[i].requests.size(); ++k) {
        if (!event.frame.remote || event.frame.id != all[i].requests[k].id) continue;
        entry.name = all[i].name;
        wire.send(static_cast<int>(i) + 1, all[i].replies[k], event.end_ns + delay_ns);
      }
      const bool is_sync = event.sender == kMaster && event.frame.id == canopen::kSyncId;
      const bool asked = all[i].at_sync ? is_sync : its_command && all[i].requests.empty();
      if (asked) answer(i, event.end_ns);
    }
    times.push_back(std::move(entry));
  }
  return times;
}

}  // namespace limber::sim
