// The controller on its LCM planes: a JOINT_TORQUE for each JOINT_STATE, an answer to each request.
#pragma once

#include <csignal>
#include <cstdint>
#include <limber/joint_state_t.hpp>
#include <string>
#include <vector>

#include "common/arm_plane/arm_plane.h"
#include "common/lcm_port.h"
#include "common/realtime.h"
#include "controller/arm_controller.h"
#include "controller/controller_log.h"
#include "controller/request_guard.h"

namespace limber {

struct ControllerProcessOptions {
  bool lockstep = false;    ///< every state is answered in order; no clock is read
  double duration_s = 0.0;  ///< ends by itself after this long; 0: never
  int priority = 0;         ///< SCHED_FIFO priority to request; 0: none
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
  /// Without a state for this long the arm counts as out of reach.
  static constexpr std::int64_t kSilence_ns = 100'000'000;

  void on_state(const joint_state_t& state) noexcept;
  void answer(const joint_state_t& state) noexcept;
  void handle_waiting() noexcept;
  void check_silence() noexcept;
  /// Guard first, then the controller.
  template <typename Request>
  Refusal judge(const Request& request) noexcept;
  /// Judges a request and publishes REQUEST_ANSWER; a refusal also goes to the log.
  template <typename Request>
  void take(const Request& request) noexcept;
  template <typename Request>
  void subscribe(const char* channel);
  void publish_status() noexcept;
  void publish_answer(const RequestOutcome& outcome, std::int64_t time_ns) noexcept;

  ArmController* controller_;
  RequestGuard guard_;
  ControllerProcessOptions options_;
  std::unique_ptr<BlackBox> black_box_;
  ControllerLog log_;
  LcmPort user_;
  RealtimeGrant grant_;
  ArmPlane arm_;
  joint_state_t newest_{};
  bool waiting_ = false;
  std::int64_t answered_session_ = 0;
  std::int64_t answered_seq_ = -1;
  std::int64_t last_state_ns_ = 0;  ///< that was new
  std::int64_t logged_ns_ = 0;
};

}  // namespace limber
