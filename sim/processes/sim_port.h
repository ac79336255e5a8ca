// The simulator's ends: CAN buses on one side, the user plane of LCM on the other.
#pragma once

#include <cstdint>
#include <limber/controller_status_t.hpp>
#include <limber/driver_status_t.hpp>
#include <limber/joint_state_t.hpp>
#include <memory>
#include <string>
#include <vector>

#include "common/lcm_port.h"
#include "common/run_lock.h"
#include "drivers/can/can_bus.h"
#include "lcmtypes/channels.h"
#include "sim/simulator.h"

namespace limber::sim {

/// Publishes SIM_TRUTH and BLOCK_TRUTH; hands PUSH, SCENARIO_EVENT and WORKPIECE to the simulator.
class SimPort {
 public:
  /// Opens the buses as they are named in `robot`. `timeline` outlives the port. Throws
  /// ConfigError.
  SimPort(const LoadedRobot& robot, const std::vector<TimedMessage>* timeline,
          const SimulatorOptions& options);

  Simulator& simulator() noexcept { return simulator_; }
  const Simulator& simulator() const noexcept { return simulator_; }

  template <typename Handler>
  void subscribe_joint_state(Handler handler);

  /// Until a frame or a message waits, or the absolute CLOCK_MONOTONIC time has come.
  void wait(std::int64_t deadline_ns) noexcept {
    wait_readable(bus_pointers_, deadline_ns, user_.descriptor());
  }
  void handle_messages() noexcept;
  void publish_truth() noexcept;
  /// Keeps what is published and heard from now on, in a black box that is kept when driver or
  /// controller has a fault. Outlives this. Set-up only.
  void set_black_box(BlackBox* box);
  /// To the log, at most once a second.
  void complain(const std::string& what);

 private:
  bool may_complain() const noexcept;
  void watch_faults(const driver_status_t& status);
  void watch_faults(const controller_status_t& status);

  static constexpr int kMessagesAtOnce = 64;  // a flood must not keep the arm

  std::vector<RunLock> locks_;  ///< a second simulator's drives would answer to the same ids
  std::vector<std::unique_ptr<CanBus>> buses_;
  std::vector<CanBus*> bus_pointers_;
  Simulator simulator_;
  LcmPort user_;
  std::int64_t complained_ns_ = 0;
  std::int64_t undecodable_told_ = 0;
  BlackBox* black_box_ = nullptr;
  int fault_ = joint_state_t::FAULT_NONE;
  int controller_mode_ = controller_status_t::MODE_BOOT;
};

template <typename Handler>
void SimPort::subscribe_joint_state(Handler handler) {
  constexpr int kQueue = 100;  // every state matters for the arm's time
  user_.subscribe<joint_state_t>(channels::kJointState, kQueue, handler);
}

}  // namespace limber::sim
