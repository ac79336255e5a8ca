// One end of a bus for a dialogue with motors that nobody commands: a request, an answer.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/can/can_bus.h"

namespace limber::motor_tools {

class Wire {
 public:
  using Accept = std::function<bool(const CanFrame&)>;
  /// Opens the bus and listens for kQuiet_s. Throws ConfigError if it cannot be opened, and as
  /// require_quiet() does.
  Wire(const std::string& address, bool fd, Accept unasked);

  /// Listens for so long. Throws std::runtime_error if somebody else sends on it what is not
  /// `unasked`: commands of a driver, or another program's.
  void require_quiet(double wait_s);

  /// Sends until an answer comes, kTries times. Nothing: there was none. Throws std::runtime_error
  /// if the bus takes no frames.
  std::optional<CanFrame> ask(const CanFrame& request, const Accept& accept);
  /// The first frame that is accepted within so many seconds.
  std::optional<CanFrame> await(const Accept& accept, double wait_s);
  /// Sends once; what comes within so many seconds goes to `heard`.
  void send(const CanFrame& frame, double wait_s,
            const std::function<void(const CanFrame&)>& heard);

  const std::string& address() const noexcept { return address_; }

  static constexpr double kQuiet_s = 0.3;
  static constexpr double kAnswer_s = 0.1;
  static constexpr int kTries = 5;

 private:
  void listen(double wait_s, const std::function<bool(const CanFrame&)>& heard);
  void put(const CanFrame& frame);

  std::string address_;
  Accept unasked_;
  std::unique_ptr<CanBus> bus_;
};

}  // namespace limber::motor_tools
