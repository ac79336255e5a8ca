// The SDO server of an emulated CANopen node: one transfer at a time, in one frame or in segments.
#pragma once

#include <array>
#include <cstdint>

#include "drivers/can/can_frame.h"
#include "drivers/protocols/canopen_sdo.h"
#include "sim/nodes/canopen_dictionary.h"

namespace limber::sim {

/// After construction every member is allowed in the cycle.
class CanopenSdoServer {
 public:
  CanopenSdoServer(CanopenDictionary* dictionary, std::uint8_t node)
      : dictionary_(dictionary), node_(node) {}

  /// False if the request wants no answer (it is none, or the client has given up).
  bool receive(const CanFrame& request, std::int64_t now_ns, CanFrame* answer) noexcept;
  /// True once when the client has left a transfer alone for too long.
  bool give_up(std::int64_t now_ns, CanFrame* abort) noexcept;
  /// Forgets a transfer that is under way.
  void reset() noexcept { direction_ = Direction::kNone; }

 private:
  enum class Direction : std::uint8_t { kNone, kReading, kWriting };

  canopen::SdoMessage work(const canopen::SdoMessage& request) noexcept;
  canopen::SdoMessage write(const canopen::SdoMessage& request) noexcept;
  canopen::SdoMessage read(const canopen::SdoMessage& request) noexcept;
  canopen::SdoMessage start_writing(const canopen::SdoMessage& request) noexcept;
  canopen::SdoMessage store_segment(const canopen::SdoMessage& request) noexcept;
  canopen::SdoMessage give_segment(const canopen::SdoMessage& request) noexcept;
  canopen::SdoMessage finish_writing() noexcept;
  canopen::SdoMessage abort(canopen::ObjectId object, canopen::SdoAbort code) noexcept;

  CanopenDictionary* dictionary_;
  std::uint8_t node_;
  Direction direction_ = Direction::kNone;
  canopen::ObjectId object_;  ///< of the transfer in segments
  std::array<std::uint8_t, DictionaryEntry::kLongest> buffer_{};
  std::size_t size_ = 0;  ///< announced
  std::size_t at_ = 0;
  bool toggle_ = false;  ///< expected next
  std::int64_t last_ns_ = 0;
};

}  // namespace limber::sim
