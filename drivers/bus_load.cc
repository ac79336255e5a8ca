#include "drivers/bus_load.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "common/config_error.h"
#include "drivers/can/frame_time.h"
#include "drivers/protocols/canopen.h"
#include "drivers/protocols/cycle_frames.h"
#include "robots/loader/adapter.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

/// Time on the wire in one cycle, s.
struct Traffic {
  double commands_s = 0.0;
  bool sync = false;  ///< no reply before the last command
  double replies_s = 0.0;
  double longest_reply_s = 0.0;
  double shortest_pair_s = std::numeric_limits<double>::infinity();
  int commands = 0;
  int replies = 0;
  double settings_s = 0.0;  ///< request and answer, of all drives that are asked
  int drives = 0;           ///< these

  void add_reply(double reply_s, double command_s) noexcept {
    replies_s += reply_s;
    ++replies;
    longest_reply_s = std::max(longest_reply_s, reply_s);
    shortest_pair_s = std::min(shortest_pair_s, command_s + reply_s);
  }
  bool none() const noexcept { return commands_s == 0.0; }
  /// The mean over cycles. Settings are asked for behind the last command, with identifiers that
  /// wait for all replies: they take wire time, but a reply waits for one such frame at most.
  double all_s() const noexcept {
    const double setting_s = drives == 0 ? 0.0 : settings_s / drives / kSettingCycles;
    return commands_s + replies_s + setting_s;
  }
};

double longest_s(const BusConfig& bus, const CanFrame& frame) noexcept {
  return worst_frame_time_s(frame.length, frame.extended, frame.fd, bus.bitrate_bps,
                            bus.data_bitrate_bps);
}

/// Mean over typical data.
double expected_s(const BusConfig& bus, const CanFrame& frame) noexcept {
  constexpr int kSamples = 64;
  std::minstd_rand random;
  CanFrame sample = frame;
  double sum_s = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    fill_typical(&sample, &random);
    sum_s += frame_time_s(sample, bus.bitrate_bps, bus.data_bitrate_bps);
  }
  return sum_s / kSamples;
}

using FrameTime = double (*)(const BusConfig&, const CanFrame&) noexcept;

Traffic traffic(const Robot& robot, int index, FrameTime time_s = longest_s) {
  const BusConfig& bus = robot.buses[static_cast<std::size_t>(index)];
  Traffic out;
  for (const Exchange& exchange : cycle_frames(robot, index)) {
    const double command_s = time_s(bus, exchange.command);
    out.commands_s += command_s;
    for (const CanFrame& request : exchange.requests) out.commands_s += time_s(bus, request);
    out.commands += 1 + static_cast<int>(exchange.requests.size());
    const double asked_s =
        exchange.requests.empty() ? command_s : time_s(bus, exchange.requests.front());
    for (const CanFrame& reply : exchange.replies) out.add_reply(time_s(bus, reply), asked_s);
    for (const CanFrame& frame : exchange.setting) out.settings_s += time_s(bus, frame);
    if (!exchange.setting.empty()) ++out.drives;
    out.sync = out.sync || exchange.at_sync;
  }
  if (out.sync) {
    out.commands_s += time_s(bus, canopen::encode_sync());
    ++out.commands;
  }
  return out;
}

const AdapterTiming& adapter_of(const Robot& robot, int bus) noexcept {
  return timing_of(robot.buses[static_cast<std::size_t>(bus)].adapter);
}

/// The longest classic frame, of another device on the bus.
double foreign_frame_s(const Robot& robot, int bus) {
  const BusConfig& config = robot.buses[static_cast<std::size_t>(bus)];
  return worst_frame_time_s(8, true, false, config.bitrate_bps, config.data_bitrate_bps);
}

}  // namespace

double predicted_bus_load(const Robot& robot, int bus) {
  return traffic(robot, bus).all_s() * robot.rate_hz;
}

double expected_bus_load(const Robot& robot, int bus) {
  return traffic(robot, bus, expected_s).all_s() * robot.rate_hz;
}

double predicted_end_s(const Robot& robot, int bus) {
  const Traffic wire = traffic(robot, bus);
  if (wire.none()) return 0.0;
  const AdapterTiming& adapter = adapter_of(robot, bus);
  const double adapter_s = adapter.send_s + adapter.receive_s + 2.0 * adapter.jitter_s;
  // The last command's reply may find the wire free; after a SYNC all of them begin together.
  const double after_s = kDriveReplyDelay_s + (wire.sync ? wire.replies_s : wire.longest_reply_s);
  // On the adapter's line all frames follow one another, out and in at once.
  const double commands_s = std::max(wire.commands_s, wire.commands * adapter.line_out_s);
  const double replies_s = std::max(wire.replies_s, wire.replies * adapter.line_in_s);
  return adapter_s + commands_s + std::max(replies_s, after_s);
}

double least_round_trip_s(const Robot& robot, int bus) {
  const Traffic wire = traffic(robot, bus);
  if (wire.none()) return 0.0;
  const AdapterTiming& adapter = adapter_of(robot, bus);
  // Stuff bits are less than a fifth of the longest frame.
  return adapter.send_s + adapter.receive_s + 0.8 * wire.shortest_pair_s;
}

double reply_window_s(const Robot& robot) {
  const double period_s = 1.0 / robot.rate_hz;
  double latest_s = 0.0;
  for (int bus = 0; bus < static_cast<int>(robot.buses.size()); ++bus) {
    const double given_s = robot.buses[static_cast<std::size_t>(bus)].reply_window_s;
    const double margin_s = std::max(0.05 * period_s, foreign_frame_s(robot, bus));
    const double predicted_s = predicted_end_s(robot, bus) + margin_s;
    latest_s = std::max(
        latest_s,
        given_s > 0.0 ? given_s : std::clamp(predicted_s, 0.6 * period_s, kLatestReply * period_s));
  }
  return latest_s;
}

double highest_rate_hz(const Robot& robot, int bus) {
  const double end_s = predicted_end_s(robot, bus);
  return end_s > 0.0 ? kLatestReply / end_s : std::numeric_limits<double>::infinity();
}

double checked_bus_load(const Robot& robot, int bus) {
  const double window_s = robot.buses[static_cast<std::size_t>(bus)].reply_window_s;
  if (window_s > kLatestReply / robot.rate_hz) {
    throw ConfigError::at(
        robot.name, 0,
        "buses." + robot.buses[static_cast<std::size_t>(bus)].name + ".reply_window_s",
        fmt::format("is {:g}; at {:g} Hz {:g} at most are allowed: the rest is the controller's",
                    window_s, robot.rate_hz, kLatestReply / robot.rate_hz));
  }
  if (robot.rate_hz <= highest_rate_hz(robot, bus)) return expected_bus_load(robot, bus);
  const BusConfig& config = robot.buses[static_cast<std::size_t>(bus)];
  const bool classic = !config.fd;
  throw ConfigError::at(
      robot.name, 0, "buses." + config.name,
      fmt::format("at {:g} Hz the last reply may come {:.2f} ms after the start of a cycle (load "
                  "{:.0f} %, adapter '{}'); {:.2f} ms are allowed; the highest rate is {:.0f} Hz "
                  "({}more buses or a faster adapter allow more)",
                  robot.rate_hz, 1e3 * predicted_end_s(robot, bus),
                  100.0 * predicted_bus_load(robot, bus), timing_of(config.adapter).word,
                  1e3 * kLatestReply / robot.rate_hz, std::floor(highest_rate_hz(robot, bus)),
                  classic ? "CAN-FD, " : ""));
}

void check_wire_delay(const Robot& robot, double delay_s, const std::string& file) {
  for (int bus = 0; bus < static_cast<int>(robot.buses.size()); ++bus) {
    const double spare_s = kLatestReply / robot.rate_hz - predicted_end_s(robot, bus);
    if (2.0 * delay_s <= std::max(spare_s, 0.0)) continue;
    throw ConfigError::at(
        file, 0, "wire.delay_s",
        fmt::format("is {:g}; on bus {} at {:g} Hz a cycle has room for {:.2g} each way: choose a "
                    "lower rate_hz for the robot",
                    delay_s, robot.buses[static_cast<std::size_t>(bus)].name, robot.rate_hz,
                    0.5 * std::max(spare_s, 0.0)));
  }
}

}  // namespace limber
