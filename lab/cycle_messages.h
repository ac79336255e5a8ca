// What driver, controller and simulator publish in a cycle, out of a lab.
#pragma once

#include <cstdint>

#include "controller/controller_log.h"
#include "lab/lab.h"
#include "lcmtypes/channels.h"

namespace limber {

class CycleMessages {
 public:
  /// After Lab::step(): `put(channel, message)` for each message, the same bytes on each channel as
  /// of the three processes.
  template <typename Put>
  void of_cycle(Lab& lab, Put put) {
    const std::int64_t time_ns = lab.state().time_ns;
    const std::int64_t seq = lab.state().seq;
    put(channels::kJointState, lab.state());
    put(channels::kSimTruth, lab.truth());
    const block_truth_t* block = lab.simulator().block_truth();
    if (block != nullptr) put(channels::kBlockTruth, *block);
    put(channels::kJointTorque, lab.torque());
    if (lab.simulator().hand_truth() != nullptr)
      put(channels::kHandTruth, *lab.simulator().hand_truth());
    if (seq % channels::kControllerStatusEvery == 0) {
      put(channels::kControllerStatus, lab.controller_status());
      if (lab.controller().hand_state() != nullptr)
        put(channels::kHandState, *lab.controller().hand_state());
    }
    if (seq % channels::kRobotInfoEvery == 0)
      put(channels::kRobotInfo, lab.controller().robot_info());
    for (const RequestOutcome& outcome : lab.controller().timeline_outcomes())
      put(channels::kRequestAnswer, answer_to(outcome, time_ns));
    if (lab.cycles() % channels::kDriverStatusEvery == 0) put_driver_status(lab, put);
  }
  /// At the end of the run.
  template <typename Put>
  void of_end(Lab& lab, Put put) {
    put_driver_status(lab, put);
  }

 private:
  template <typename Put>
  void put_driver_status(Lab& lab, Put put) {
    driver_status_t status = lab.driver_status();
    status.seq = status_seq_++;
    put(channels::kDriverStatus, status);
  }

  std::int64_t status_seq_ = 0;
};

}  // namespace limber
