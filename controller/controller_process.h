// The controller on its LCM planes: a JOINT_TORQUE for each JOINT_STATE, an answer to each request.
#pragma once

#include <csignal>
#include <cstdint>
#include <limber/joint_state_t.hpp>
#include <string>
#include <vector>

#include "common/arm_plane/arm_plane.h"
#include "common/lcm_port.h"
#include "common/pace.h"
#include "common/realtime.h"
#include "controller/arm_controller.h"
#include "controller/controller_log.h"
#include "controller/request_desk.h"

namespace limber {

struct ControllerProcessOptions {
  Pace pace = Pace::kRealtime;  ///< in lock step every state is answered in order
  double duration_s = 0.0;      ///< ends by itself after this long; 0: never
  int priority = 0;             ///< SCHED_FIFO priority to request; 0: none
  /// Some bus is no simulated one: requests must not come from the network.
  bool moves_motors = false;
  std::vector<std::string> joints;  ///< names, for the log
  std::string robot;                ///< its name, for the black box
  double rate_hz = 1000.0;          ///< for the black box
};

class ControllerProcess {
 public:
  /// Opens both planes, see require_local(). The controller outlives the process. Throws
  /// ConfigError.
  ControllerProcess(ArmController* controller, const ControllerProcessOptions& options);

  /// Runs until the duration is over or `stop` is set.
  void run(const volatile std::sig_atomic_t& stop) noexcept;

 private:
  /// Without a state for this long, or for three cycles, the arm counts as out of reach.
  static constexpr std::int64_t kSilence_ns = 100'000'000;

  void on_state(const joint_state_t& state) noexcept;
  void answer(const joint_state_t& state) noexcept;
  void handle_waiting() noexcept;
  void check_silence() noexcept;
  void publish_status() noexcept;

  ArmController* controller_;
  ControllerProcessOptions options_;
  std::unique_ptr<BlackBox> black_box_;
  ControllerLog log_;
  LcmPort user_;
  RequestDesk desk_;
  RealtimeGrant grant_;
  ArmPlane arm_;
  joint_state_t newest_{};
  bool waiting_ = false;
  std::int64_t answered_session_ = 0;
  std::int64_t silence_ns_ = kSilence_ns;
  std::int64_t answered_seq_ = -1;
  std::int64_t last_state_ns_ = 0;  ///< that was new
};

}  // namespace limber
