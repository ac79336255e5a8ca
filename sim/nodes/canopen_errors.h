// The errors of an emulated CANopen node: which are active, what is reported on the bus, and
// which there were.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "drivers/protocols/canopen.h"
#include "sim/nodes/canopen_dictionary.h"

namespace limber::sim {

/// Writes the error register 1001h and the history 1003h. After construction every member is
/// allowed in the cycle.
class CanopenErrors {
 public:
  explicit CanopenErrors(CanopenDictionary* dictionary);

  /// True, with the frame to report, if the error is a new one.
  bool raise(std::uint16_t code, std::uint8_t register_bit, canopen::Emergency* message) noexcept;
  /// True likewise if that was the last one.
  bool clear(std::uint16_t code, canopen::Emergency* message) noexcept;
  bool clear_all(canopen::Emergency* message) noexcept;
  /// Code of the latest error that is still there; 0: none.
  std::uint16_t latest() const noexcept {
    return count_ > 0 ? errors_[static_cast<std::size_t>(count_ - 1)].code : std::uint16_t{0};
  }
  void forget_history() noexcept;

 private:
  static constexpr int kMost = 8;
  static constexpr int kHistory = 8;
  struct Error {
    std::uint16_t code = 0;
    std::uint8_t register_bit = 0;
  };

  std::uint8_t error_register() noexcept;
  bool all_gone(canopen::Emergency* message) noexcept;

  CanopenDictionary* dictionary_;
  std::array<Error, kMost> errors_{};
  int count_ = 0;
};

}  // namespace limber::sim
