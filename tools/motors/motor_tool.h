// What a person does with one motor before it is part of an arm: one class a family, listed in
// motor_tools.cc. Nothing here commands a torque.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/yaml_reader.h"
#include "tools/can/reading.h"
#include "tools/motors/wire.h"

namespace limber::motor_tools {

struct Found {
  int number = 0;
  std::string details;  ///< "replies as 0x11"
};

/// How a setting is kept.
enum class Format : std::uint8_t { kText, kFloat, kFloatOrNone, kInt16, kUint8, kUint16, kUint32 };
/// Of a number; NaN is a value of kFloatOrNone alone.
Range range_of(Format format) noexcept;

/// One of the things that a motor has stored.
struct Setting {
  enum class Use : std::uint8_t {
    kModel,     ///< tells the model: settings of another are not for this motor
    kWritable,  ///< a number that restore writes
    kOther,     ///< has a command of its own, or the maker's tool changes it
  };
  std::string name;   ///< by the maker's manual, with the unit
  std::string value;  ///< so that it reads back as the same number; empty: not in this firmware
  Use use = Use::kOther;
  Format format = Format::kText;
  /// The key of robot.yaml that has the same, "motors.*.mit_range.torque_Nm"; "most.torque_Nm": an
  /// end that robot.yaml has by another name.
  std::string robot_key = {};
};

/// A bit rate that a motor can have: of the data in CAN-FD frames, if it has those.
struct BitRate {
  std::int64_t bps;
  std::uint8_t code;  ///< of the protocol
};

/// What a motor measures, behind its gear; NaN: its protocol does not tell.
struct Measured {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  double angle_rad = kUnknown;
  double velocity_rad_per_s = kUnknown;
  double torque_Nm = kUnknown;
  double temperature_degC = kUnknown;
  double supply_V = kUnknown;
  std::string state;  ///< in words, errors among them
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
  /// Of presence(): it also does so to drives of other families with this number.
  virtual bool presence_switches_off() const noexcept { return false; }
  virtual std::optional<Found> found(const CanFrame& frame) const = 0;
  /// Whether the drive with this number takes any frame with this 11-bit identifier for its own.
  virtual bool obeys(int /*number*/, std::uint32_t /*id*/) const noexcept { return false; }

  Wire::Accept comes_from(int number) const;  ///< found() of this motor

  /// Whether its drives send the frame by themselves.
  virtual bool sends_unasked(const CanFrame& frame) const noexcept {
    static_cast<void>(frame);
    return false;
  }

  /// Throws std::runtime_error if it does not answer.
  virtual Measured measure(Wire* wire, int number, bool fd) const = 0;
  /// All of its settings that the protocol reads. Likewise.
  virtual std::vector<Setting> settings(Wire* wire, int number, bool fd) const = 0;
  /// What settings() lack of its family, as a sentence; empty: nothing.
  virtual std::string_view not_read() const noexcept { return ""; }
  /// Until its supply is switched off: a writable one of settings(). Throws std::runtime_error if
  /// the drive refuses it.
  virtual void write(Wire* wire, int number, const Setting& setting, double value, bool fd) const;
  /// Keeps what was written. False: the drive cannot.
  virtual bool store(Wire* wire, int number, bool fd) const;
  /// Whether its power stage is on.
  virtual bool enabled(Wire* wire, int number, bool fd) const = 0;
  /// Stored and read back. Throws std::runtime_error if it is not as wanted then, or the maker's
  /// tool is needed.
  virtual void set_number(Wire* wire, int number, int wanted, bool fd) const = 0;
  /// Makes where it is its zero, stored and read back. Likewise.
  virtual void set_zero(Wire* wire, int number, bool fd) const = 0;

  /// Those that its protocol sets; empty: the maker's tool does.
  virtual std::span<const BitRate> bit_rates() const noexcept { return {}; }
  /// Sets one of them; what has become of it, in words. Throws std::runtime_error if the drive
  /// refuses it.
  virtual std::string set_bit_rate(Wire* wire, int number, const BitRate& rate, bool fd) const;

 protected:
  // What was set, read back; throw std::runtime_error if it is not so.
  void require_number(Wire* wire, int wanted, bool fd) const;
  static void require_zero(double angle_rad);
};

std::span<const MotorTool* const> all_tools() noexcept;
/// Throws ConfigError if there is none.
const MotorTool& tool_of(const std::string& protocol);

}  // namespace limber::motor_tools
