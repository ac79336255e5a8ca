// The controller with its sockets: waits for states, answers them, hears users.
#pragma once

#include <cstdint>
#include <limber/joint_state_t.hpp>

#include "common/lcm_port.h"
#include "common/realtime.h"
#include "controller/arm_controller.h"

namespace limber {

struct ControllerProcessOptions {
  bool lockstep = false;    ///< every state is answered in order; no clock decides anything
  double duration_s = 0.0;  ///< ends by itself after this long; 0: never
  int priority = 0;         ///< SCHED_FIFO priority to ask for; 0: do not ask
};

class ControllerProcess {
 public:
  /// Opens both planes. The controller outlives the process. Throws ConfigError.
  ControllerProcess(ArmController* controller, const ControllerProcessOptions& options);

  /// Runs until the duration is over or `stop` becomes true.
  void run(const volatile bool& stop) noexcept;

 private:
  /// Without a state for this long the arm counts as out of reach.
  static constexpr std::int64_t kSilence_ns = 100'000'000;

  void on_state(const joint_state_t& state) noexcept;
  void answer(const joint_state_t& state) noexcept;
  void handle_waiting() noexcept;
  void watch_silence() noexcept;
  /// Tells the user what became of a request, and the log if it was refused.
  template <typename Request>
  void reply(const Request& request, const char* what, const char* reason) noexcept;
  void complain(const char* what, const char* reason) noexcept;

  ArmController* controller_;
  ControllerProcessOptions options_;
  LcmPort user_;
  RealtimeGrant grant_;  // between the planes, see the constructor
  LcmPort arm_;
  joint_state_t newest_{};
  bool waiting_ = false;
  std::int64_t answered_session_ = 0;
  std::int64_t answered_seq_ = -1;
  std::int64_t heard_ns_ = 0;
  std::int64_t complained_ns_ = 0;
};

}  // namespace limber
