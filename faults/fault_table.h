// The faults of a bus and its drives that are injected: one table, one row a fault.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "faults/fault_stage.h"

namespace limber::faults {

struct Fault {
  std::string name;  ///< in the tables of docs/bus.md
  /// Causes the fault, in an arm that moves.
  std::function<void(FaultStage*)> begin = {};
  /// What the drives have stored that differs from robot.yaml, from the start; then the arm is not
  /// to be enabled. Empty: nothing.
  std::function<void(DriveConfig*)> stored = {};
  /// The drives leave ON within so many cycles; 0: the fault is bridged and counted.
  int most_cycles = 0;
  int watched_cycles = 100;
  /// Words of the protocols that know the fault; empty: all.
  std::vector<DriveProtocol> protocols = {};
};

std::span<const Fault> fault_table();

/// An arm of each family of drives.
struct Family {
  DriveProtocol protocol;
  const char* robot;
};
std::span<const Family> families();
bool applies(const Fault& fault, DriveProtocol protocol);

/// One fault on one family, at a phase of the motion: 0, 1, 2, ... Throws std::runtime_error if the
/// arm does not come up.
Reaction react(const Fault& fault, const LoadedRobot& robot, int phase);

}  // namespace limber::faults
