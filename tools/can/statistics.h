// Counts the frames of an arm's buses: rates and gaps of each identifier, load of each bus.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "robots/loader/robot.h"
#include "tools/can/bus_decoder.h"

namespace limber::bus_tools {

struct IdentifierCount {
  std::string who;  ///< of the first frame
  Direction direction = Direction::kForeign;
  std::int64_t frames = 0;
  std::int64_t first_ns = 0;
  std::int64_t last_ns = 0;
  std::int64_t greatest_gap_ns = 0;
  double busy_s = 0.0;  ///< time on the wire, its stuff bits counted
};

class BusStatistics {
 public:
  explicit BusStatistics(const Robot& robot);

  void add(std::int64_t time_ns, int bus, const CanFrame& frame);
  /// A table a bus, with the load it had and the load that robot.yaml predicts.
  std::string text() const;

 private:
  using Identifier = std::pair<std::uint32_t, bool>;  // and whether it has 29 bits
  struct OneBus {
    explicit OneBus(const Robot& robot, int bus) : decoder(robot, bus) {}
    BusDecoder decoder;
    std::map<Identifier, IdentifierCount> identifiers;
    std::uint32_t (*kind)(std::uint32_t id) = nullptr;  ///< DriveProtocol::kind of its drives
    std::int64_t error_frames = 0;
    std::int64_t lockstep_frames = 0;  ///< on no real bus
    std::int64_t first_ns = 0;
    std::int64_t last_ns = 0;
    bool any = false;
  };
  std::string text_of(const OneBus& bus, int index) const;

  const Robot& robot_;
  std::vector<OneBus> buses_;
};

}  // namespace limber::bus_tools
