// Where frames come from: the buses of an arm, or a file in candump's log format.
#pragma once

#include <csignal>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "drivers/can/can_bus.h"
#include "robots/loader/robot.h"

namespace limber::bus_tools {

struct FrameSource {
  std::string file;       ///< empty: the buses themselves
  double duration_s = 0;  ///< of listening; 0: until `stop`
  const volatile std::sig_atomic_t* stop = nullptr;
};

/// A frame with its time: of the file; of arrival since 1970 if heard. False: enough.
using FrameSink = std::function<bool(std::int64_t time_ns, int bus, const CanFrame& frame)>;

/// Frames that this end of the buses has lost, and datagrams that were none.
struct ListeningLosses {
  std::int64_t overflow = 0;
  std::int64_t malformed = 0;
  std::map<std::string, std::int64_t> elsewhere;  ///< of a file's interfaces that are none of these
};

/// Gives every frame to `sink`. A file's interfaces are the names of the robot's buses, or of their
/// addresses; frames of other interfaces are counted only. `idle` is called now and then while
/// nothing arrives. Throws ConfigError.
ListeningLosses each_frame(const Robot& robot, const FrameSource& source, const FrameSink& sink,
                           const std::function<void()>& idle = {});

/// The robot's bus that a file's interface is; none: another arm's, or a gripper's.
std::optional<int> bus_of_interface(const Robot& robot, const std::string& interface);

/// Which interfaces were left out, how many frames each, and what to do if one is a bus.
std::string elsewhere_text(const Robot& robot, const ListeningLosses& losses);

/// To listen and replay: in user space with FD frames always, else if the bus carries them.
std::unique_ptr<CanBus> open_bus(const BusConfig& bus);

}  // namespace limber::bus_tools
