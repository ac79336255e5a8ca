// Frames of the moteus register protocol: identifiers, and the subframes that a frame is a row of.
// Bytes only: no I/O, no state beyond the frame, no heap. Everything is allowed inside the cycle.
//
//   subframe = opcode, [count], first register, values     count and register: 7 bits a byte, low
//            | opcode, channel, count, [text]              ones first, bit 7 = more follows
//
// The second kind is the tunnel of the diagnostic channel, a stream of text both ways: the client
// hands text over, and polls for what the drive has to say.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "drivers/can/can_frame.h"
#include "drivers/protocols/moteus_registers.h"

#pragma GCC visibility push(default)
namespace limber::moteus {

/// Source and destination: seven bits each, the host is 0, destination 0x7F is everybody.
struct Address {
  std::uint8_t source = 0;
  std::uint8_t destination = 0;
  bool reply_wanted = false;
  std::uint16_t prefix = 0;  ///< 13 bits
};
inline constexpr std::uint8_t kBroadcast = 0x7F;

/// prefix | reply wanted | source | destination. Sent as a 29-bit identifier above 0x7FF.
std::uint32_t can_id(const Address& address) noexcept;
Address address_of(std::uint32_t can_id) noexcept;

inline constexpr std::uint8_t kUnknownRegister = 1;
inline constexpr std::uint8_t kNotWritable = 2;
/// Channel of the text; drives have no other.
inline constexpr std::uint8_t kTextChannel = 1;
/// Bytes of text in a frame that has nothing else.
inline constexpr std::size_t kMostText = 61;

/// Fills a frame subframe by subframe. One that does not fit is left out whole and gives false.
class FrameWriter {
 public:
  explicit FrameWriter(std::uint32_t id) noexcept;

  bool write(Type type, Register first, std::span<const double> values) noexcept;
  bool read(Type type, std::uint16_t first, unsigned count) noexcept;
  bool reply(Type type, std::uint16_t first, std::span<const double> values) noexcept;
  bool write_error(std::uint16_t reg, std::uint8_t error) noexcept;
  bool read_error(std::uint16_t reg, std::uint8_t error) noexcept;
  bool text_to_drive(std::string_view text) noexcept;
  bool text_poll(unsigned most) noexcept;
  bool text_from_drive(std::string_view text) noexcept;

  /// Bytes of text that still fit into one subframe.
  std::size_t room_for_text() const noexcept;
  /// The frame, filled up with NOPs to a length that CAN-FD has; with bit-rate switch.
  CanFrame frame() const noexcept;

 private:
  bool begin(unsigned opcode, Type type, unsigned first, std::size_t count) noexcept;
  bool values(unsigned opcode, Type type, unsigned first, std::span<const double> values) noexcept;
  bool error(std::uint8_t opcode, std::uint16_t reg, std::uint8_t error) noexcept;
  /// False if the frame is full, and from then on: the last byte of a subframe tells of all.
  bool put(std::uint32_t byte) noexcept;
  bool put_varuint(std::uint32_t value) noexcept;
  bool put_value(Type type, double lsb, double value) noexcept;
  bool text(std::uint8_t opcode, std::string_view text) noexcept;
  bool kept_if(bool fits, std::uint8_t start) noexcept;

  CanFrame frame_;
};

struct Subframe {
  enum class Kind : std::uint8_t {
    kWrite,
    kRead,
    kReply,
    kWriteError,
    kReadError,
    kTextToDrive,
    kTextFromDrive,
    kTextPoll
  };
  Kind kind = Kind::kRead;
  Type type = Type::kInt8;
  std::uint16_t first = 0;  ///< register; of text: channel
  unsigned count = 0;       ///< registers; 1 for errors; of text: bytes, of a poll the most
  std::uint8_t error = 0;
  const std::uint8_t* data = nullptr;  ///< of writes, replies, text; lives as long as the frame

  /// Value of register first + i, in the register's unit; NaN where the format has it.
  double value(unsigned i) const noexcept;
  std::string_view text() const noexcept;
};

/// Takes a frame apart; the frame outlives the reader.
class FrameReader {
 public:
  explicit FrameReader(const CanFrame& frame) noexcept : frame_(frame) {}

  /// The next subframe, NOPs skipped. False at the end, and for good at the first thing that
  /// cannot be parsed.
  bool next(Subframe* subframe) noexcept;
  bool malformed() const noexcept { return malformed_; }

 private:
  bool parse(std::uint8_t opcode, Subframe* subframe) noexcept;
  bool parse_text(std::uint8_t opcode, Subframe* subframe) noexcept;
  /// `value` is 0 before.
  bool take_varuint(std::uint32_t* value) noexcept;

  const CanFrame& frame_;
  std::uint8_t at_ = 0;
  bool malformed_ = false;
};

}  // namespace limber::moteus
#pragma GCC visibility pop
