// Live requests of the user plane: each is judged, carried out or refused, and answered.
#pragma once

#include <cstdint>

#include "common/lcm_port.h"
#include "controller/arm_controller.h"
#include "controller/request_guard.h"

namespace limber {

class RequestDesk {
 public:
  /// Subscribes to all requests of channels.yaml to the controller: they are taken while `user`
  /// handles what waits. Both outlive this, at its place. Throws ConfigError.
  RequestDesk(ArmController* controller, LcmPort* user);
  RequestDesk(const RequestDesk&) = delete;
  RequestDesk& operator=(const RequestDesk&) = delete;

  /// Publishes REQUEST_ANSWER; a refusal also goes to the log. `time_ns`: arm time.
  void answer(const RequestOutcome& outcome, std::int64_t time_ns) noexcept;

 private:
  template <typename Request>
  using Decide = Refusal (ArmController::*)(const Request&) noexcept;
  template <typename Request>
  void subscribe(const char* channel, Decide<Request> decide);
  /// Guard first, then the controller.
  template <typename Request>
  Refusal judge(const Request& request, Decide<Request> decide) noexcept;

  /// A refusal, of which few a second are answered.
  bool worth_an_answer(const RequestOutcome& outcome) noexcept;

  ArmController* controller_;
  LcmPort* user_;
  RequestGuard guard_;
  std::int64_t logged_ns_ = 0;
  std::int64_t refused_ns_ = 0;
};

}  // namespace limber
