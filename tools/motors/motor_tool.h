// What a person does with one motor before it is part of an arm: one class a family, listed in
// motor_tools.cc. Nothing here commands a torque.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/can/reading.h"
#include "tools/motors/wire.h"

namespace limber::motor_tools {

using bus_tools::Value;

struct Found {
  int number = 0;
  std::string details;  ///< "replies as 0x11"
};

class MotorTool {
 public:
  virtual ~MotorTool() = default;

  /// `protocol:` of robot.yaml.
  virtual std::string_view protocol() const noexcept = 0;
  virtual bool needs_fd() const noexcept { return false; }
  /// Numbers that its drives can have: 1 to this.
  virtual int last_number() const noexcept = 0;

  /// A request that the drive with this number answers, and that changes nothing.
  virtual CanFrame presence(int number, bool fd) const noexcept = 0;
  virtual std::optional<Found> found(const CanFrame& frame) const = 0;

  /// Whether its drives send the frame by themselves.
  virtual bool sends_unasked(const CanFrame& frame) const noexcept {
    static_cast<void>(frame);
    return false;
  }

  /// What it has stored and measures. Throws std::runtime_error if it does not answer.
  virtual std::vector<Value> show(Wire* wire, int number, bool fd) const = 0;
  /// Whether its power stage is on.
  virtual bool enabled(Wire* wire, int number, bool fd) const = 0;
  /// Stored and read back. Throws std::runtime_error if it is not as wanted then, or the maker's
  /// tool is needed.
  virtual void set_number(Wire* wire, int number, int wanted, bool fd) const = 0;
  /// Makes where it is its zero, stored and read back. Likewise.
  virtual void set_zero(Wire* wire, int number, bool fd) const = 0;

 protected:
  // What was set, read back; throw std::runtime_error if it is not so.
  void require_number(Wire* wire, int wanted, bool fd) const;
  static void require_zero(double angle_rad);
};

std::span<const MotorTool* const> all_tools() noexcept;
/// Throws ConfigError if there is none.
const MotorTool& tool_of(const std::string& protocol);

}  // namespace limber::motor_tools
