// Sends entries of a scenario to a running stack and tells what became of them.
#pragma once

#include <cstdint>
#include <limber/request_answer_t.hpp>
#include <optional>
#include <string>

#include "common/lcm_port.h"
#include "robots/loader/load_robot.h"
#include "scenarios/loader/entry_yaml.h"

namespace limber {

/// A user with a lease of its own.
class RequestSender {
 public:
  /// Throws ConfigError if there is no multicast route.
  RequestSender(const LoadedRobot& robot, std::int64_t client);

  /// Sends one entry, such as `gains: {law: salisbury}`, and waits for the controller's answer (for
  /// a push, wall, payload or fault, which the simulator takes, for nothing). Throws ConfigError if
  /// the entry is wrong, no controller answers, or it refuses, with its reason.
  void send_entry(const std::string& entry);

 private:
  /// Number of the controller that runs now. Throws ConfigError if none does.
  std::int64_t running_controller();
  /// In words; of the last answer.
  std::string refusal() const;
  void send(const ScenarioMessage& message, std::int64_t controller);
  template <typename Condition>
  bool wait_for(Condition met);

  const LoadedRobot& robot_;
  std::int64_t client_;
  EntryContext context_;
  LcmPort port_;
  std::int64_t seq_ = 0;
  std::optional<std::int64_t> controller_;
  std::int8_t mode_ = 0;  ///< of the controller, as heard last
  std::optional<request_answer_t> answer_;
};

}  // namespace limber
