#include "tools/can/frame_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "common/clock.h"
#include "common/config_error.h"
#include "common/wall_clock.h"
#include "drivers/can/can_bus.h"
#include "drivers/can/candump_log.h"

namespace limber::bus_tools {
namespace {

constexpr std::int64_t kIdle_ns = 100'000'000;

struct Heard {
  int bus;
  CanFrame frame;
};

class Listener {
 public:
  explicit Listener(const Robot& robot) {
    for (const BusConfig& bus : robot.buses) {
      buses_.push_back(open_bus(bus));
      ends_.push_back(buses_.back().get());
      last_ns_.push_back(0);
    }
  }

  /// All that waits, or that comes before the deadline, in order of arrival.
  const std::vector<Heard>& wait(std::int64_t deadline_ns) {
    heard_.clear();
    if (!wait_readable(ends_, deadline_ns)) return heard_;
    for (std::size_t bus = 0; bus < ends_.size(); ++bus) take(static_cast<int>(bus), *ends_[bus]);
    std::ranges::stable_sort(heard_, {}, [](const Heard& one) { return one.frame.timestamp_ns; });
    return heard_;
  }

  ListeningLosses losses() const {
    ListeningLosses losses;
    for (const CanBus* bus : ends_) {
      losses.overflow += bus->statistics().overflow;
      losses.malformed += bus->statistics().malformed;
    }
    return losses;
  }

 private:
  /// The kernel's stamps, brought to another clock, may go back by microseconds: frames of one bus
  /// keep their order.
  void take(int index, CanBus& bus) {
    std::int64_t& last_ns = last_ns_[static_cast<std::size_t>(index)];
    std::array<CanFrame, 64> frames;
    for (int count; (count = bus.receive(frames)) > 0;) {
      for (int i = 0; i < count; ++i) {
        CanFrame& frame = frames[static_cast<std::size_t>(i)];
        frame.timestamp_ns = last_ns = std::max(last_ns, frame.timestamp_ns);
        heard_.push_back({index, frame});
      }
    }
  }

  std::vector<std::unique_ptr<CanBus>> buses_;
  std::vector<CanBus*> ends_;
  std::vector<std::int64_t> last_ns_;
  std::vector<Heard> heard_;
};

ListeningLosses listen(const Robot& robot, const FrameSource& source, const FrameSink& sink,
                       const std::function<void()>& idle) {
  Listener listener(robot);
  const std::int64_t offset_ns = epoch_minus_monotonic_ns();
  const std::int64_t start_ns = monotonic_ns();
  const auto end_ns = start_ns + static_cast<std::int64_t>(source.duration_s * 1e9);
  bool enough = false;
  while (!enough && (source.stop == nullptr || *source.stop == 0)) {
    const std::int64_t now_ns = monotonic_ns();
    if (source.duration_s > 0.0 && now_ns >= end_ns) break;
    for (const Heard& heard : listener.wait(now_ns + kIdle_ns)) {
      enough = !sink(heard.frame.timestamp_ns + offset_ns, heard.bus, heard.frame);
      if (enough) break;
    }
    if (idle) idle();
  }
  return listener.losses();
}

}  // namespace

std::unique_ptr<CanBus> open_bus(const BusConfig& bus) {
  const bool fd = bus.fd || is_virtual(bus.can);
  return open_can_bus(bus.can, fd, Stamps::kOnArrival, bus.bitrate_bps);
}

std::optional<int> bus_of_interface(const Robot& robot, const std::string& interface) {
  for (std::size_t i = 0; i < robot.buses.size(); ++i) {
    const BusConfig& bus = robot.buses[i];
    if (interface == bus.name || interface == candump_interface(bus.can))
      return static_cast<int>(i);
  }
  return std::nullopt;
}

std::string elsewhere_text(const Robot& robot, const ListeningLosses& losses) {
  std::string others;
  std::string known;
  for (const auto& [name, frames] : losses.elsewhere)
    others += fmt::format("{}{} ({} frames)", others.empty() ? "" : ", ", name, frames);
  for (const BusConfig& bus : robot.buses)
    known +=
        fmt::format("{}{} ({})", known.empty() ? "" : ", ", bus.name, candump_interface(bus.can));
  return fmt::format(
      "{}: none of {}'s buses, which are {}; if one of them is, add --bus "
      "{}=socketcan:{}",
      others, robot.name, known, robot.buses.front().name, losses.elsewhere.begin()->first);
}

ListeningLosses each_frame(const Robot& robot, const FrameSource& source, const FrameSink& sink,
                           const std::function<void()>& idle) {
  if (source.file.empty()) return listen(robot, source, sink, idle);
  CandumpReader reader(source.file);
  LoggedFrame logged;
  ListeningLosses losses;
  bool any = false;
  while ((source.stop == nullptr || *source.stop == 0) && reader.next(&logged)) {
    const std::optional<int> bus = bus_of_interface(robot, logged.interface);
    any = any || bus;
    if (!bus) {
      ++losses.elsewhere[logged.interface];
    } else if (!sink(logged.time_ns, *bus, logged.frame)) {
      break;
    }
  }
  if (!any && !losses.elsewhere.empty())
    throw ConfigError::at(source.file, 0, "", elsewhere_text(robot, losses));
  return losses;
}

}  // namespace limber::bus_tools
