#include "qa/faults/fault_table.h"

#include <algorithm>
#include <stdexcept>

namespace limber::faults {
namespace {

constexpr int kStartCycle = 2000;  // the arm has been weighed (controller/watches/load_watch.h)
constexpr int kPhaseCycles = 137;  // has no factor in common with
constexpr int kCircleCycles = 1000;
constexpr int kPassedAfter = 50;
/// Of the trace, before a fault.
constexpr int kRecordedCycles = 100;

std::vector<Fault> all_faults() {
  std::vector<Fault> all = bus_faults();
  for (const std::vector<Fault>& more : {controller_faults(), feedback_faults()})
    all.insert(all.end(), more.begin(), more.end());
  return all;
}

Reaction react_from_start(const Fault& fault, const LoadedRobot& robot, const Run& run) {
  LoadedRobot drives = robot;
  fault.stored(&drives.robot);
  FaultStage stage(robot, &drives);
  stage.run(1);
  if (!run.trace.empty()) stage.record(run.trace);
  return stage.watch(fault.watched_cycles);
}

}  // namespace

const char* name_of(Place place) noexcept {
  switch (place) {
    case Place::kBus:
      return "bus";
    case Place::kController:
      return "controller";
    case Place::kFeedback:
      break;
  }
  return "feedback";
}

std::span<const Fault> fault_table() {
  static const std::vector<Fault> table = all_faults();
  return table;
}

bool applies(const Fault& fault, std::string_view protocol) {
  return fault.protocols.empty() ||
         std::ranges::find(fault.protocols, protocol) != fault.protocols.end();
}

Reaction react(const Fault& fault, const LoadedRobot& robot, const Run& run) {
  if (fault.stored) return react_from_start(fault, robot, run);
  const int begin = kStartCycle + run.phase * kPhaseCycles % kCircleCycles;
  const std::int64_t first = fault.passes > 0 ? fault.passes - kPassedAfter - begin : 0;
  FaultStage stage(robot, nullptr, first);
  stage.seed(static_cast<unsigned>(run.phase) + 1);
  stage.run(begin - kRecordedCycles);
  if (!run.trace.empty()) stage.record(run.trace);
  stage.run(begin);
  if (!stage.moves()) throw std::runtime_error(robot.robot.name + ": the arm does not come up");
  if (fault.begin) fault.begin(&stage);
  Reaction reaction = stage.watch(fault.watched_cycles);
  reaction.fault_ns = (first + begin) * static_cast<std::int64_t>(1e9 / robot.robot.rate_hz);
  return reaction;
}

}  // namespace limber::faults
