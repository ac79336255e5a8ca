// How a serial CAN adapter writes frames as bytes, and what it answers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "drivers/can/can_frame.h"

namespace limber {

/// What a byte from the adapter has completed.
enum class SerialEvent : std::uint8_t {
  kNothing,
  kFrame,
  kRefused,  ///< the adapter has not sent a frame of ours
  kGarbage,  ///< bytes were skipped: one answer was damaged
};

/// One exchange that opens the adapter's CAN side.
struct SerialGreeting {
  std::string bytes;
  std::string meaning;      ///< "a bit rate of 1000000 bit/s"
  bool may_refuse = false;  ///< such as to close what is closed
};

/// Classic frames only. One instance a line: it keeps what has arrived of an answer.
class SerialCodec {
 public:
  static constexpr std::size_t kLongest = 32;  ///< bytes of a frame on the line

  virtual ~SerialCodec() = default;

  /// Set-up. Throws ConfigError if the adapter has no such bit rate.
  virtual std::vector<SerialGreeting> greetings(int bitrate_bps) const = 0;
  /// What ends its CAN side.
  virtual std::string farewell() const = 0;

  // Allowed inside the cycle.

  /// Writes a possible classic frame; returns the number of bytes.
  virtual std::size_t encode(const CanFrame& frame, std::span<std::uint8_t> out) const noexcept = 0;
  virtual SerialEvent take(std::uint8_t byte, CanFrame* frame) noexcept = 0;
  /// Forgets the answer that has begun.
  virtual void reset() noexcept = 0;
};

/// Text lines of LAWICEL's CANUSB, as the kernel's slcan: CANable, many others.
std::unique_ptr<SerialCodec> make_slcan_codec();

/// Damiao's USB-to-CAN adapter: records of 30 bytes out and 16 in. Its bit rate is set with the
/// maker's tool.
std::unique_ptr<SerialCodec> make_damiao_serial_codec();

}  // namespace limber
