#include "tools/can/statistics.h"

#include <fmt/format.h>

#include <algorithm>

#include "drivers/bus_load.h"
#include "drivers/can/frame_time.h"
#include "drivers/can/lockstep_frame.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber::bus_tools {
namespace {

void count(std::int64_t time_ns, double busy_s, IdentifierCount* identifier) {
  if (identifier->frames++ == 0)
    identifier->first_ns = time_ns;
  else
    identifier->greatest_gap_ns =
        std::max(identifier->greatest_gap_ns, time_ns - identifier->last_ns);
  identifier->last_ns = time_ns;
  identifier->busy_s += busy_s;
}

std::string row(const std::pair<std::uint32_t, bool>& id, const IdentifierCount& count,
                double span_s) {
  const auto gaps = static_cast<double>(count.frames - 1);
  const double mean_s =
      gaps > 0 ? 1e-9 * static_cast<double>(count.last_ns - count.first_ns) / gaps : 0.0;
  const auto or_dash = [](double value, int decimals) {
    return value > 0.0 ? fmt::format("{:.{}f}", value, decimals) : std::string("-");
  };
  return fmt::format("  {:>8}  {:<16} {:<8} {:>9} {:>10} {:>10} {:>10} {:>8}\n",
                     hex(id.first, id.second ? 8 : 3), count.who, word_of(count.direction),
                     count.frames, or_dash(mean_s > 0.0 ? 1.0 / mean_s : 0.0, 1),
                     or_dash(1e3 * mean_s, 3),
                     or_dash(1e-6 * static_cast<double>(count.greatest_gap_ns), 3),
                     or_dash(span_s > 0.0 ? 100.0 * count.busy_s / span_s : 0.0, 2));
}

}  // namespace

BusStatistics::BusStatistics(const Robot& robot) : robot_(robot) {
  for (int bus = 0; bus < static_cast<int>(robot.buses.size()); ++bus)
    buses_.emplace_back(robot, bus);
  for (const JointConfig& joint : robot.driven()) {
    auto& kind = buses_[static_cast<std::size_t>(joint.drive.bus)].kind;
    if (kind == nullptr) kind = joint.drive.protocol->kind;
  }
}

void BusStatistics::add(std::int64_t time_ns, int index, const CanFrame& frame) {
  OneBus& bus = buses_[static_cast<std::size_t>(index)];
  if (!bus.any) bus.first_ns = time_ns;
  bus.any = true;
  bus.last_ns = std::max(bus.last_ns, time_ns);
  const Reading reading = bus.decoder.read(frame);
  if (frame.error) {
    ++bus.error_frames;
    return;
  }
  if (lockstep::is_tick(frame) || lockstep::is_tock(frame)) {
    ++bus.lockstep_frames;
    return;
  }
  std::uint32_t id = frame.id;
  if (bus.kind != nullptr && frame.extended) id = bus.kind(id);
  IdentifierCount& identifier = bus.identifiers[{id, frame.extended}];
  if (identifier.frames == 0) {
    identifier.who = reading.who;
    identifier.direction = reading.direction;
  } else if (identifier.who != reading.who) {
    identifier.who = "several";
  }
  const BusConfig& config = robot_.buses[static_cast<std::size_t>(index)];
  count(time_ns, frame_time_s(frame, config.bitrate_bps, config.data_bitrate_bps), &identifier);
}

std::string BusStatistics::text() const {
  std::string text;
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    if (i > 0) text += '\n';
    text += text_of(buses_[i], static_cast<int>(i));
  }
  return text;
}

std::string BusStatistics::text_of(const OneBus& bus, int index) const {
  const BusConfig& config = robot_.buses[static_cast<std::size_t>(index)];
  const double span_s = 1e-9 * static_cast<double>(bus.last_ns - bus.first_ns);
  std::string text = fmt::format("bus {} ({}), {:.3f} s\n", config.name, config.can, span_s);
  if (bus.identifiers.empty()) return text + "  no frames\n";
  text += fmt::format("  {:>8}  {:<16} {:<8} {:>9} {:>10} {:>10} {:>10} {:>8}\n", "id", "joint", "",
                      "frames", "rate Hz", "mean ms", "gap ms", "load %");
  double busy_s = 0.0;
  for (const auto& [id, identifier] : bus.identifiers) {
    text += row(id, identifier, span_s);
    busy_s += identifier.busy_s;
  }
  if (bus.error_frames > 0) text += fmt::format("  {} error frames\n", bus.error_frames);
  if (span_s > 0.0)
    text += fmt::format(
        "  load {:.1f} % of {:g} Mbit/s{}", 100.0 * busy_s / span_s, 1e-6 * config.bitrate_bps,
        config.fd ? fmt::format(" + {:g} Mbit/s", 1e-6 * config.data_bitrate_bps) : "");
  if (robot_.has_drives)
    text += fmt::format("; predicted at {:g} Hz: {:.1f} %, at most {:.1f} %", robot_.rate_hz,
                        100.0 * expected_bus_load(robot_, index),
                        100.0 * predicted_bus_load(robot_, index));
  text += "\n";
  if (bus.lockstep_frames > 0)
    text += fmt::format(
        "  {} frames TICK and TOCK of lock step, which no real bus has, are not counted\n",
        bus.lockstep_frames);
  return text;
}

}  // namespace limber::bus_tools
