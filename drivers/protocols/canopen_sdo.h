// CANopen's service data objects as bytes (CiA 301): a client reads and writes one object of a
// node's dictionary at a time. Objects of up to four bytes travel in one frame each way, longer
// ones in segments of seven. Both directions, no I/O, no state; everything is allowed in the cycle.
#pragma once

#include <array>
#include <cstdint>

#include "drivers/can/can_frame.h"
#include "drivers/protocols/canopen.h"

#pragma GCC visibility push(default)
namespace limber::canopen {

enum class SdoAbort : std::uint32_t {
  kToggle = 0x05030000,
  kTimeout = 0x05040000,
  kUnknownCommand = 0x05040001,
  kUnsupportedAccess = 0x06010000,
  kWriteOnly = 0x06010001,
  kReadOnly = 0x06010002,
  kNoSuchObject = 0x06020000,
  kNotMappable = 0x06040041,
  kPdoTooLong = 0x06040042,
  kLength = 0x06070010,
  kNoSuchSub = 0x06090011,
  kValueRange = 0x06090030,
  kTooHigh = 0x06090031,
  kTooLow = 0x06090032,
  kCannotStore = 0x08000020,
  kWrongState = 0x08000022,
};
/// The code in words, for messages; "unknown abort code" for codes not listed.
const char* text_of(SdoAbort code) noexcept;

/// One frame of a transfer. What a kind carries besides the object:
enum class SdoKind : std::uint8_t {
  kWrite,         ///< request: value and its bytes; answer: nothing more, also to kStartWrite
  kRead,          ///< request: nothing more; answer: value and its bytes
  kStartWrite,    ///< request only: value is the size of what follows in segments, 0 if not given
  kStartRead,     ///< answer only: likewise
  kWriteSegment,  ///< request: segment, toggle, last; answer: toggle. No object
  kReadSegment,   ///< request: toggle; answer: segment, toggle, last. No object
  kAbort,         ///< value is the SdoAbort
  kUnknown,       ///< decoded only: a command that does not exist here, block transfers for one
};

struct SdoMessage {
  SdoKind kind = SdoKind::kUnknown;
  ObjectId object;
  std::uint32_t value = 0;
  std::uint8_t bytes = 0;  ///< of the value or segment; 0 with a value: not given
  bool toggle = false;
  bool last = false;
  std::array<std::uint8_t, 7> segment{};
};

// What a client usually needs.
CanFrame encode_sdo_read(ObjectId object, std::uint8_t node) noexcept;
/// Negative values and float32 (mit::float_bits) as their bits.
CanFrame encode_sdo_write(const Object& object, std::uint32_t value, std::uint8_t node) noexcept;

CanFrame encode_sdo_request(const SdoMessage& message, std::uint8_t node) noexcept;
/// Of a request, whatever node it is for: the start of a write, or a part of one.
bool is_sdo_write(const CanFrame& request) noexcept;
CanFrame encode_sdo_answer(const SdoMessage& message, std::uint8_t node) noexcept;
/// False unless the frame is an SDO frame of this node in that direction: identifier, eight bytes.
[[nodiscard]] bool decode_sdo_request(const CanFrame& frame, std::uint8_t node,
                                      SdoMessage* message) noexcept;
[[nodiscard]] bool decode_sdo_answer(const CanFrame& frame, std::uint8_t node,
                                     SdoMessage* message) noexcept;

}  // namespace limber::canopen
#pragma GCC visibility pop
