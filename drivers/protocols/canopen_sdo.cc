#include "drivers/protocols/canopen_sdo.h"

#include <algorithm>

namespace limber::canopen {
namespace {

// Byte 0 of a frame: the command in its upper three bits.
constexpr unsigned kCommandMask = 0xE0;
constexpr unsigned kWriteSegmentRequest = 0x00;
constexpr unsigned kStartWriteRequest = 0x20;
constexpr unsigned kStartReadRequest = 0x40;
constexpr unsigned kReadSegmentRequest = 0x60;
constexpr unsigned kBlockWriteRequest = 0xC0;
constexpr unsigned kReadSegmentAnswer = 0x00;
constexpr unsigned kWriteSegmentAnswer = 0x20;
constexpr unsigned kStartReadAnswer = 0x40;
constexpr unsigned kWriteAnswer = 0x60;
constexpr unsigned kAbortCommand = 0x80;
// Its lower bits: of a start, and of a segment.
constexpr unsigned kExpedited = 0x02;
constexpr unsigned kSizeGiven = 0x01;
constexpr unsigned kToggle = 0x10;
constexpr unsigned kLast = 0x01;

constexpr std::uint8_t kSegmentBytes = 7;

std::uint8_t low_byte(std::uint32_t value) noexcept { return static_cast<std::uint8_t>(value); }

void put_object(const SdoMessage& message, CanFrame* frame) noexcept {
  frame->data[1] = low_byte(message.object.index);
  frame->data[2] = low_byte(message.object.index >> 8U);
  frame->data[3] = message.object.sub;
  for (unsigned i = 0; i < 4; ++i) frame->data[4 + i] = low_byte(message.value >> (8 * i));
}

void take_object(const CanFrame& frame, SdoMessage* message) noexcept {
  message->object.index = static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8U);
  message->object.sub = frame.data[3];
  for (unsigned i = 0; i < 4; ++i)
    message->value |= static_cast<std::uint32_t>(frame.data[4 + i]) << (8 * i);
}

/// An expedited value or the start of segments.
unsigned start_bits(const SdoMessage& message, bool expedited) noexcept {
  if (!expedited) return message.value > 0 ? kSizeGiven : 0U;
  return message.bytes == 0
             ? kExpedited
             : kExpedited | kSizeGiven | (4U - std::min<unsigned>(4, message.bytes)) << 2U;
}

void take_start(unsigned command, SdoKind expedited, SdoKind in_segments,
                SdoMessage* message) noexcept {
  const bool is_expedited = (command & kExpedited) != 0;
  const bool size_given = (command & kSizeGiven) != 0;
  message->kind = is_expedited ? expedited : in_segments;
  if (is_expedited && size_given)
    message->bytes = static_cast<std::uint8_t>(4U - (command >> 2U & 3U));
  if (message->bytes > 0 && message->bytes < 4) message->value &= (1U << 8U * message->bytes) - 1U;
  if (!is_expedited && !size_given) message->value = 0;
}

unsigned put_segment(const SdoMessage& message, CanFrame* frame) noexcept {
  const unsigned bytes = std::min<unsigned>(message.bytes, kSegmentBytes);
  std::copy_n(message.segment.begin(), bytes, frame->data.begin() + 1);
  return (message.toggle ? kToggle : 0U) | (kSegmentBytes - bytes) << 1U |
         (message.last ? kLast : 0U);
}

void take_segment(const CanFrame& frame, SdoKind kind, SdoMessage* message) noexcept {
  message->kind = kind;
  message->bytes = static_cast<std::uint8_t>(kSegmentBytes - (frame.data[0] >> 1U & 7U));
  message->last = (frame.data[0] & kLast) != 0;
  std::copy_n(frame.data.begin() + 1, message->bytes, message->segment.begin());
}

bool is_sdo(const CanFrame& frame, std::uint32_t id) noexcept {
  return has_id(frame, id) && !frame.remote && frame.length == 8;
}

CanFrame empty_frame(std::uint32_t id) noexcept {
  CanFrame frame;
  frame.id = id;
  frame.length = 8;
  return frame;
}

}  // namespace

CanFrame encode_sdo_read(ObjectId object, std::uint8_t node) noexcept {
  return encode_sdo_request({SdoKind::kRead, object}, node);
}

CanFrame encode_sdo_write(const Object& object, std::uint32_t value, std::uint8_t node) noexcept {
  const std::uint32_t mask = object.bytes < 4 ? (1U << 8U * object.bytes) - 1U : ~0U;
  return encode_sdo_request({SdoKind::kWrite, object.id, value & mask, object.bytes}, node);
}

CanFrame encode_sdo_request(const SdoMessage& message, std::uint8_t node) noexcept {
  CanFrame frame = empty_frame(kSdoRequestCode + node);
  unsigned command = kAbortCommand;
  switch (message.kind) {
    case SdoKind::kWrite:
    case SdoKind::kStartWrite:
      put_object(message, &frame);
      command = kStartWriteRequest | start_bits(message, message.kind == SdoKind::kWrite);
      break;
    case SdoKind::kRead:
    case SdoKind::kStartRead:
      put_object({SdoKind::kRead, message.object}, &frame);
      command = kStartReadRequest;
      break;
    case SdoKind::kWriteSegment:
      command = kWriteSegmentRequest | put_segment(message, &frame);
      break;
    case SdoKind::kReadSegment:
      command = kReadSegmentRequest | (message.toggle ? kToggle : 0U);
      break;
    case SdoKind::kAbort:
    case SdoKind::kUnknown:
      put_object(message, &frame);
      break;
  }
  frame.data[0] = low_byte(command);
  return frame;
}

bool is_sdo_write(const CanFrame& request) noexcept {
  const unsigned command = request.data[0] & kCommandMask;
  return request.length == 8 && !request.remote &&
         (command == kStartWriteRequest || command == kWriteSegmentRequest ||
          command == kBlockWriteRequest);
}

CanFrame encode_sdo_answer(const SdoMessage& message, std::uint8_t node) noexcept {
  CanFrame frame = empty_frame(kSdoAnswerCode + node);
  unsigned command = kAbortCommand;
  switch (message.kind) {
    case SdoKind::kWrite:
    case SdoKind::kStartWrite:
      put_object({SdoKind::kWrite, message.object}, &frame);
      command = kWriteAnswer;
      break;
    case SdoKind::kRead:
    case SdoKind::kStartRead:
      put_object(message, &frame);
      command = kStartReadAnswer | start_bits(message, message.kind == SdoKind::kRead);
      break;
    case SdoKind::kWriteSegment:
      command = kWriteSegmentAnswer | (message.toggle ? kToggle : 0U);
      break;
    case SdoKind::kReadSegment:
      command = kReadSegmentAnswer | put_segment(message, &frame);
      break;
    case SdoKind::kAbort:
    case SdoKind::kUnknown:
      put_object(message, &frame);
      break;
  }
  frame.data[0] = low_byte(command);
  return frame;
}

bool decode_sdo_request(const CanFrame& frame, std::uint8_t node, SdoMessage* message) noexcept {
  if (!is_sdo(frame, kSdoRequestCode + node)) return false;
  *message = {};
  take_object(frame, message);
  message->toggle = (frame.data[0] & kToggle) != 0;
  switch (frame.data[0] & kCommandMask) {
    case kWriteSegmentRequest:
      take_segment(frame, SdoKind::kWriteSegment, message);
      break;
    case kStartWriteRequest:
      take_start(frame.data[0], SdoKind::kWrite, SdoKind::kStartWrite, message);
      break;
    case kStartReadRequest:
      message->kind = SdoKind::kRead;
      break;
    case kReadSegmentRequest:
      message->kind = SdoKind::kReadSegment;
      break;
    case kAbortCommand:
      message->kind = SdoKind::kAbort;
      break;
    default:
      break;
  }
  return true;
}

bool decode_sdo_answer(const CanFrame& frame, std::uint8_t node, SdoMessage* message) noexcept {
  if (!is_sdo(frame, kSdoAnswerCode + node)) return false;
  *message = {};
  take_object(frame, message);
  message->toggle = (frame.data[0] & kToggle) != 0;
  switch (frame.data[0] & kCommandMask) {
    case kReadSegmentAnswer:
      take_segment(frame, SdoKind::kReadSegment, message);
      break;
    case kWriteSegmentAnswer:
      message->kind = SdoKind::kWriteSegment;
      break;
    case kStartReadAnswer:
      take_start(frame.data[0], SdoKind::kRead, SdoKind::kStartRead, message);
      break;
    case kWriteAnswer:
      message->kind = SdoKind::kWrite;
      break;
    case kAbortCommand:
      message->kind = SdoKind::kAbort;
      break;
    default:
      break;
  }
  return true;
}

const char* text_of(SdoAbort code) noexcept {
  switch (code) {
    case SdoAbort::kToggle:
      return "toggle bit did not alternate";
    case SdoAbort::kTimeout:
      return "transfer timed out";
    case SdoAbort::kUnknownCommand:
      return "unknown command";
    case SdoAbort::kUnsupportedAccess:
      return "access not supported";
    case SdoAbort::kWriteOnly:
      return "object is write only";
    case SdoAbort::kReadOnly:
      return "object is read only";
    case SdoAbort::kNoSuchObject:
      return "no such object";
    case SdoAbort::kNotMappable:
      return "object cannot be mapped into a PDO";
    case SdoAbort::kPdoTooLong:
      return "PDO would be too long";
    case SdoAbort::kLength:
      return "length does not match";
    case SdoAbort::kNoSuchSub:
      return "no such subindex";
    case SdoAbort::kValueRange:
      return "value out of range";
    case SdoAbort::kTooHigh:
      return "value too high";
    case SdoAbort::kTooLow:
      return "value too low";
    case SdoAbort::kCannotStore:
      return "value cannot be stored";
    case SdoAbort::kWrongState:
      return "not in the present state of the device";
  }
  return "unknown abort code";
}

}  // namespace limber::canopen
