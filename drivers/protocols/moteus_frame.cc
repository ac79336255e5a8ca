#include "drivers/protocols/moteus_frame.h"

#include <bit>

namespace limber::moteus {
namespace {

// Opcodes; to the first three the number format (times 4) and a count of 1 to 3 are added.
constexpr std::uint8_t kWrite = 0x00;
constexpr std::uint8_t kRead = 0x10;
constexpr std::uint8_t kReply = 0x20;
constexpr std::uint8_t kWriteError = 0x30;
constexpr std::uint8_t kReadError = 0x31;
constexpr std::uint8_t kTextToDrive = 0x40;
constexpr std::uint8_t kTextFromDrive = 0x41;
constexpr std::uint8_t kTextPoll = 0x42;
constexpr std::uint8_t kNop = 0x50;

constexpr std::size_t kLongestFrame = 64;
constexpr std::uint32_t kLastRegister = 0xFFFF;

std::int32_t sign_extended(std::uint32_t raw, int bytes) noexcept {
  const auto unused = static_cast<unsigned>(32 - 8 * bytes);
  return static_cast<std::int32_t>(raw << unused) >> unused;
}

}  // namespace

std::uint32_t can_id(const Address& address) noexcept {
  return (address.prefix & 0x1FFFU) << 16U | (address.reply_wanted ? 0x8000U : 0U) |
         (address.source & 0x7FU) << 8U | (address.destination & 0x7FU);
}

Address address_of(std::uint32_t can_id) noexcept {
  return {static_cast<std::uint8_t>(can_id >> 8U & 0x7FU),
          static_cast<std::uint8_t>(can_id & 0x7FU), (can_id & 0x8000U) != 0,
          static_cast<std::uint16_t>(can_id >> 16U & 0x1FFFU)};
}

// --- writing -------------------------------------------------------------------------------------

FrameWriter::FrameWriter(std::uint32_t id) noexcept {
  frame_.id = id;
  frame_.extended = id > kStandardIdMax;
  frame_.fd = true;
  frame_.bitrate_switch = true;
}

bool FrameWriter::put(std::uint32_t byte) noexcept {
  if (frame_.length >= kLongestFrame) return false;
  frame_.data[frame_.length++] = static_cast<std::uint8_t>(byte);
  return true;
}

bool FrameWriter::put_varuint(std::uint32_t value) noexcept {
  while (value > 0x7FU) {
    if (!put((value & 0x7FU) | 0x80U)) return false;
    value >>= 7U;
  }
  return put(value);
}

bool FrameWriter::put_value(Type type, double lsb, double value) noexcept {
  std::uint32_t raw = type == Type::kFloat
                          ? std::bit_cast<std::uint32_t>(static_cast<float>(value))
                          : static_cast<std::uint32_t>(to_integer(value, lsb, type));
  for (int i = 0; i < size_of(type); ++i, raw >>= 8U) {
    if (!put(raw & 0xFFU)) return false;
  }
  return true;
}

bool FrameWriter::kept_if(bool fits, std::uint8_t start) noexcept {
  if (!fits) frame_.length = start;
  return fits;
}

bool FrameWriter::begin(unsigned opcode, Type type, unsigned first, std::size_t count) noexcept {
  const unsigned shape = opcode | static_cast<unsigned>(type) << 2U;
  const bool counted = count >= 1 && count <= 3
                           ? put(shape | static_cast<unsigned>(count))
                           : put(shape) && put_varuint(static_cast<std::uint32_t>(count));
  return counted && put_varuint(first);
}

bool FrameWriter::values(unsigned opcode, Type type, unsigned first,
                         std::span<const double> values) noexcept {
  const std::uint8_t start = frame_.length;
  bool fits = begin(opcode, type, first, values.size());
  for (std::size_t i = 0; i < values.size() && fits; ++i)
    fits = put_value(type, lsb(static_cast<std::uint16_t>(first + i), type), values[i]);
  return kept_if(fits, start);
}

bool FrameWriter::write(Type type, Register first, std::span<const double> values) noexcept {
  return this->values(kWrite, type, static_cast<unsigned>(first), values);
}

bool FrameWriter::reply(Type type, std::uint16_t first, std::span<const double> values) noexcept {
  return this->values(kReply, type, first, values);
}

bool FrameWriter::read(Type type, std::uint16_t first, unsigned count) noexcept {
  const std::uint8_t start = frame_.length;
  return kept_if(begin(kRead, type, first, count), start);
}

bool FrameWriter::write_error(std::uint16_t reg, std::uint8_t error) noexcept {
  const std::uint8_t start = frame_.length;
  return kept_if(put(kWriteError) && put_varuint(reg) && put_varuint(error), start);
}

bool FrameWriter::read_error(std::uint16_t reg, std::uint8_t error) noexcept {
  const std::uint8_t start = frame_.length;
  return kept_if(put(kReadError) && put_varuint(reg) && put_varuint(error), start);
}

bool FrameWriter::text(std::uint8_t opcode, std::string_view text) noexcept {
  const std::uint8_t start = frame_.length;
  bool fits =
      put(opcode) && put(kTextChannel) && put_varuint(static_cast<std::uint32_t>(text.size()));
  for (std::size_t i = 0; i < text.size() && fits; ++i)
    fits = put(static_cast<std::uint8_t>(text[i]));
  return kept_if(fits, start);
}

bool FrameWriter::text_to_drive(std::string_view text) noexcept {
  return this->text(kTextToDrive, text);
}

bool FrameWriter::text_from_drive(std::string_view text) noexcept {
  return this->text(kTextFromDrive, text);
}

bool FrameWriter::text_poll(unsigned most) noexcept {
  const std::uint8_t start = frame_.length;
  return kept_if(put(kTextPoll) && put(kTextChannel) && put_varuint(most), start);
}

std::size_t FrameWriter::room_for_text() const noexcept {
  constexpr std::size_t kHead = 3;  // opcode, channel, count
  const std::size_t used = frame_.length + kHead;
  return used < kLongestFrame ? kLongestFrame - used : 0;
}

CanFrame FrameWriter::frame() const noexcept {
  CanFrame padded = frame_;
  padded.length = static_cast<std::uint8_t>(fd_length(frame_.length));
  for (std::size_t i = frame_.length; i < padded.length; ++i) padded.data[i] = kNop;
  return padded;
}

// --- reading -------------------------------------------------------------------------------------

double Subframe::value(unsigned i) const noexcept {
  const int bytes = size_of(type);
  const std::uint8_t* at = data + i * static_cast<unsigned>(bytes);
  std::uint32_t raw = 0;
  for (int b = 0; b < bytes; ++b) raw |= static_cast<std::uint32_t>(at[b]) << (8 * b);
  if (type == Type::kFloat) return static_cast<double>(std::bit_cast<float>(raw));
  return from_integer(sign_extended(raw, bytes), lsb(static_cast<std::uint16_t>(first + i), type),
                      type);
}

std::string_view Subframe::text() const noexcept {
  return {reinterpret_cast<const char*>(data), data == nullptr ? 0 : count};
}

bool FrameReader::next(Subframe* subframe) noexcept {
  while (at_ < frame_.length && frame_.data[at_] == kNop) ++at_;
  if (malformed_ || at_ >= frame_.length) return false;
  malformed_ = !parse(frame_.data[at_++], subframe);
  return !malformed_;
}

bool FrameReader::parse(std::uint8_t opcode, Subframe* subframe) noexcept {
  std::uint32_t count = opcode & 3U;
  std::uint32_t first = 0;
  *subframe = {};
  if (opcode == kWriteError || opcode == kReadError) {
    std::uint32_t error = 0;
    if (!take_varuint(&first) || !take_varuint(&error) || first > kLastRegister || error > 0xFF)
      return false;
    subframe->kind =
        opcode == kWriteError ? Subframe::Kind::kWriteError : Subframe::Kind::kReadError;
    subframe->first = static_cast<std::uint16_t>(first);
    subframe->count = 1;
    subframe->error = static_cast<std::uint8_t>(error);
    return true;
  }
  if (opcode >= kTextToDrive && opcode <= kTextPoll) return parse_text(opcode, subframe);
  if (opcode >= kReply + 0x10) return false;
  if (count == 0 && !take_varuint(&count)) return false;
  if (!take_varuint(&first) || first > kLastRegister || count > kLastRegister - first) return false;
  subframe->kind = opcode < kRead    ? Subframe::Kind::kWrite
                   : opcode < kReply ? Subframe::Kind::kRead
                                     : Subframe::Kind::kReply;
  subframe->type = static_cast<Type>(opcode >> 2U & 3U);
  subframe->first = static_cast<std::uint16_t>(first);
  subframe->count = count;
  if (subframe->kind == Subframe::Kind::kRead) return true;
  const std::uint32_t bytes = count * static_cast<std::uint32_t>(size_of(subframe->type));
  if (bytes > static_cast<std::uint32_t>(frame_.length - at_)) return false;
  subframe->data = frame_.data.data() + at_;
  at_ = static_cast<std::uint8_t>(at_ + bytes);
  return true;
}

bool FrameReader::parse_text(std::uint8_t opcode, Subframe* subframe) noexcept {
  std::uint32_t channel = 0;
  std::uint32_t count = 0;
  if (!take_varuint(&channel) || !take_varuint(&count) || channel > kLastRegister) return false;
  subframe->kind = opcode == kTextToDrive ? Subframe::Kind::kTextToDrive
                   : opcode == kTextPoll  ? Subframe::Kind::kTextPoll
                                          : Subframe::Kind::kTextFromDrive;
  subframe->first = static_cast<std::uint16_t>(channel);
  subframe->count = count;
  if (subframe->kind == Subframe::Kind::kTextPoll) return true;
  if (count > static_cast<std::uint32_t>(frame_.length - at_)) return false;
  subframe->data = frame_.data.data() + at_;
  at_ = static_cast<std::uint8_t>(at_ + count);
  return true;
}

bool FrameReader::take_varuint(std::uint32_t* value) noexcept {
  *value = 0;
  for (unsigned shift = 0; shift < 28 && at_ < frame_.length; shift += 7) {
    const std::uint8_t byte = frame_.data[at_++];
    *value |= static_cast<std::uint32_t>(byte & 0x7FU) << shift;
    if (byte < 0x80) return true;
  }
  return false;
}

}  // namespace limber::moteus
