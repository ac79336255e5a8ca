// The faults that are injected: one table, one row a fault.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "qa/faults/fault_stage.h"

namespace limber::faults {

/// Where a fault is; those of the bus are in the table of docs/bus.md.
enum class Place : std::uint8_t { kBus, kController, kFeedback };
const char* name_of(Place place) noexcept;

struct Fault {
  std::string name;  ///< in docs/bus.md and faults/matrix.yaml
  /// Causes the fault, in an arm that moves.
  std::function<void(FaultStage*)> begin = {};
  /// How the drives differ from robot.yaml, from the start; then the arm is not to be enabled.
  /// Empty: not at all.
  std::function<void(Robot*)> stored = {};
  /// The drives leave ON within so many cycles; 0: the fault is bridged and counted.
  int most_cycles = 0;
  int watched_cycles = 100;
  /// Words of the protocols that know the fault; empty: all.
  std::vector<std::string_view> protocols = {};
  Place place = Place::kBus;
  /// The count of cycles, and arm time with it, passes this number in the 50th cycle after the
  /// beginning; 0: it counts from 0.
  std::int64_t passes = 0;
};

/// All of them.
std::span<const Fault> fault_table();
// Its parts.
std::vector<Fault> bus_faults();
std::vector<Fault> controller_faults();
std::vector<Fault> feedback_faults();

/// `protocol`: of the drives.
bool applies(const Fault& fault, std::string_view protocol);

struct Run {
  int phase = 0;      ///< of the motion: 0, 1, 2, ...; all below 1000 differ. Also the seed.
  std::string trace;  ///< candump log to write, from 0.1 s before the fault on; empty: none
};
/// One fault on one arm. Throws std::runtime_error if the arm does not come up, ConfigError if the
/// trace cannot be written.
Reaction react(const Fault& fault, const LoadedRobot& robot, const Run& run);

}  // namespace limber::faults
