#include "sim/processes/sim_port.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/clock.h"
#include "common/problem_text.h"
#include "common/tell.h"
#include "sim/processes/world_requests.h"

namespace limber::sim {
namespace {

constexpr std::int64_t kComplaintInterval_ns = 1'000'000'000;
constexpr int kUserQueue = 100;

std::vector<RunLock> lock_buses(const Robot& robot) {
  std::vector<RunLock> locks;
  for (const BusConfig& bus : robot.buses) locks.emplace_back("simulator of " + bus.can);
  return locks;
}

std::vector<std::unique_ptr<CanBus>> open_buses(const Robot& robot) {
  std::vector<std::unique_ptr<CanBus>> buses;
  for (const BusConfig& bus : robot.buses) buses.push_back(open_can_bus(bus.can, bus.fd));
  return buses;
}

std::vector<CanBus*> pointers(const std::vector<std::unique_ptr<CanBus>>& buses) {
  std::vector<CanBus*> out;
  for (const auto& bus : buses) out.push_back(bus.get());
  return out;
}

}  // namespace

SimPort::SimPort(const LoadedRobot& robot, const std::vector<TimedMessage>* timeline,
                 const SimulatorOptions& options)
    : locks_(lock_buses(robot.robot)),
      buses_(open_buses(robot.robot)),
      bus_pointers_(pointers(buses_)),
      simulator_(robot, bus_pointers_, options),
      user_(user_plane_url()) {
  simulator_.set_timeline(timeline);
  take_world_requests(&user_, &simulator_, [this](const char* what) { complain(what); });
}

void SimPort::handle_messages() noexcept {
  user_.handle_waiting(kMessagesAtOnce);
  if (user_.undecodable() == undecodable_told_ || !may_complain()) return;
  undecodable_told_ = user_.undecodable();
  tell([this] {
    complain(fmt::format(
        "{} messages to the simulator (PUSH, SCENARIO_EVENT, WORKPIECE) were dropped: no such "
        "message, or of another version of limber",
        undecodable_told_));
  });
}

void SimPort::publish_truth() noexcept {
  user_.publish(channels::kSimTruth, simulator_.truth());
  const block_truth_t* block = simulator_.block_truth();
  if (block != nullptr) user_.publish(channels::kBlockTruth, *block);
  if (const hand_truth_t* hand = simulator_.hand_truth())
    user_.publish(channels::kHandTruth, *hand);
}

void SimPort::set_black_box(BlackBox* box) {
  black_box_ = box;
  if (box == nullptr) return;
  user_.set_black_box(box);
  user_.subscribe<controller_status_t>(
      channels::kControllerStatus, kUserQueue,
      [this](const controller_status_t& status) { watch_faults(status); });
  user_.subscribe<driver_status_t>(channels::kDriverStatus, kUserQueue,
                                   [this](const driver_status_t& status) { watch_faults(status); });
}

void SimPort::watch_faults(const driver_status_t& status) {
  if (status.fault == fault_) return;
  fault_ = status.fault;
  const Problem* problem = find_problem(problems::kDriver, fault_);
  if (problem != nullptr && fault_ != joint_state_t::FAULT_REQUESTED)
    keep(black_box_, problem->code);
}

void SimPort::watch_faults(const controller_status_t& status) {
  if (status.mode == controller_mode_) return;
  controller_mode_ = status.mode;
  const Problem* problem = find_problem(problems::kController, status.reason);
  const bool follows = status.reason == controller_status_t::REASON_DRIVER_FAULT;
  if (problem != nullptr && !follows && status.mode == controller_status_t::MODE_FAULT)
    keep(black_box_, problem->code);
}

bool SimPort::may_complain() const noexcept {
  return complained_ns_ == 0 || monotonic_ns() - complained_ns_ >= kComplaintInterval_ns;
}

void SimPort::complain(const std::string& what) {
  if (!may_complain()) return;
  complained_ns_ = monotonic_ns();
  spdlog::warn("{}", what);
}

}  // namespace limber::sim
