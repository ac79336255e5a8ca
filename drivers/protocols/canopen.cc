#include "drivers/protocols/canopen.h"

namespace limber::canopen {
namespace {

constexpr int kLongestFrame = 64;

CanFrame classic_frame(std::uint32_t id, std::uint8_t length) noexcept {
  CanFrame frame;
  frame.id = id;
  frame.length = length;
  return frame;
}

bool is_plain(const CanFrame& frame, std::uint32_t id, std::uint8_t length) noexcept {
  return has_id(frame, id) && !frame.remote && frame.length == length;
}

bool exists(NmtCommand command) noexcept {
  switch (command) {
    case NmtCommand::kStart:
    case NmtCommand::kStop:
    case NmtCommand::kPreOperational:
    case NmtCommand::kResetNode:
    case NmtCommand::kResetCommunication:
      return true;
  }
  return false;
}

bool exists(NmtState state) noexcept {
  switch (state) {
    case NmtState::kBootUp:
    case NmtState::kStopped:
    case NmtState::kOperational:
    case NmtState::kPreOperational:
      return true;
  }
  return false;
}

}  // namespace

CanFrame encode_nmt(NmtCommand command, std::uint8_t node) noexcept {
  CanFrame frame = classic_frame(kNmtId, 2);
  frame.data[0] = static_cast<std::uint8_t>(command);
  frame.data[1] = node;
  return frame;
}

bool decode_nmt(const CanFrame& frame, std::uint8_t node, NmtCommand* command) noexcept {
  if (!is_plain(frame, kNmtId, 2)) return false;
  const auto received = static_cast<NmtCommand>(frame.data[0]);
  if (!exists(received) || (frame.data[1] != 0 && frame.data[1] != node)) return false;
  *command = received;
  return true;
}

CanFrame encode_heartbeat(NmtState state, std::uint8_t node) noexcept {
  CanFrame frame = classic_frame(kHeartbeatCode + node, 1);
  frame.data[0] = static_cast<std::uint8_t>(state);
  return frame;
}

bool decode_heartbeat(const CanFrame& frame, std::uint8_t node, NmtState* state) noexcept {
  if (!is_plain(frame, kHeartbeatCode + node, 1)) return false;
  const auto received = static_cast<NmtState>(frame.data[0]);
  if (!exists(received)) return false;
  *state = received;
  return true;
}

CanFrame encode_sync() noexcept { return classic_frame(kSyncId, 0); }

CanFrame encode_sync(std::uint8_t counter) noexcept {
  CanFrame frame = classic_frame(kSyncId, 1);
  frame.data[0] = counter;
  return frame;
}

const char* emergency_text(std::uint16_t code) noexcept {
  struct Row {
    std::uint16_t code;
    const char* text;
  };
  constexpr Row kCodes[] = {
      {0x0000, "all errors are gone"}, {kOverCurrent, "over-current"},
      {0x3210, "over-voltage"},        {0x3220, "under-voltage"},
      {kDriveTooHot, "drive too hot"}, {kHeartbeatLost, "heartbeat lost"},
      {kPdoTooShort, "PDO too short"}, {kSyncLength, "SYNC of unexpected length"},
      {kRpdoTimeout, "RPDO time-out"},
  };
  constexpr Row kClasses[] = {{0x10, "generic"},       {0x20, "current"},    {0x30, "voltage"},
                              {0x40, "temperature"},   {0x50, "hardware"},   {0x60, "software"},
                              {0x70, "added modules"}, {0x80, "monitoring"}, {0x90, "external"},
                              {0xF0, "manufacturer"}};
  for (const Row& row : kCodes) {
    if (row.code == code) return row.text;
  }
  if ((code & 0xFF00U) == kCommunicationError) return "communication";
  for (const Row& row : kClasses) {
    if (row.code == (code >> 8U & 0xF0U)) return row.text;
  }
  return "unknown";
}

CanFrame encode_emergency(const Emergency& emergency, std::uint8_t node) noexcept {
  CanFrame frame = classic_frame(kEmergencyCode + node, 8);
  frame.data[0] = static_cast<std::uint8_t>(emergency.code);
  frame.data[1] = static_cast<std::uint8_t>(emergency.code >> 8U);
  frame.data[2] = emergency.error_register;
  for (std::size_t i = 0; i < emergency.vendor.size(); ++i) frame.data[3 + i] = emergency.vendor[i];
  return frame;
}

bool decode_emergency(const CanFrame& frame, std::uint8_t node, Emergency* emergency) noexcept {
  if (node == 0 || !is_plain(frame, kEmergencyCode + node, 8)) return false;
  emergency->code = static_cast<std::uint16_t>(frame.data[0] | frame.data[1] << 8U);
  emergency->error_register = frame.data[2];
  for (std::size_t i = 0; i < emergency->vendor.size(); ++i)
    emergency->vendor[i] = frame.data[3 + i];
  return true;
}

// --- fields --------------------------------------------------------------------------------------

FieldWriter::FieldWriter(std::uint32_t id, bool fd) noexcept {
  frame_.id = id;
  frame_.fd = fd;
  frame_.bitrate_switch = fd;
}

void FieldWriter::put(std::uint32_t value, int bytes) noexcept {
  if (frame_.length + bytes > (frame_.fd ? kLongestFrame : 8)) return;
  for (int i = 0; i < bytes; ++i, value >>= 8U)
    frame_.data[frame_.length++] = static_cast<std::uint8_t>(value);
}

CanFrame FieldWriter::frame() const noexcept {
  CanFrame padded = frame_;
  padded.length = static_cast<std::uint8_t>(fd_length(frame_.length));
  return padded;
}

std::uint32_t FieldReader::take(int bytes) noexcept {
  complete_ = complete_ && at_ + bytes <= frame_.length;
  if (!complete_) return 0;
  std::uint32_t value = 0;
  for (int i = 0; i < bytes; ++i)
    value |= static_cast<std::uint32_t>(frame_.data[static_cast<std::size_t>(at_ + i)]) << (8 * i);
  at_ += bytes;
  return value;
}

std::int32_t FieldReader::take_signed(int bytes) noexcept {
  const auto unused = static_cast<unsigned>(32 - 8 * bytes);
  return static_cast<std::int32_t>(take(bytes) << unused) >> unused;
}

}  // namespace limber::canopen
