#include "drivers/can/frame_time.h"

#include <algorithm>
#include <array>

namespace limber {
namespace {

constexpr int kTrailerBits =
    13;  // CRC delimiter, acknowledge slot and delimiter, end of frame, gap
constexpr int kFdStuffCountBits = 4;  // three bits of count and their parity

/// CRC field of an FD frame, with the stuff bits at its fixed places.
constexpr int fd_crc_bits(int bytes) noexcept { return bytes <= 16 ? 17 + 6 : 21 + 7; }

/// Bits as they leave a controller: after five equal ones comes one of the other kind.
struct Stuffing {
  int run = 0;  ///< so many bits of one kind were sent last: zeros below 0, ones above
  int stuffed = 0;

  constexpr void put(std::uint32_t bit) noexcept {
    run = bit != 0 ? (run > 0 ? run + 1 : 1) : (run < 0 ? run - 1 : -1);
    if (run != 5 && run != -5) return;
    ++stuffed;
    run = run > 0 ? -1 : 1;
  }
};

constexpr std::uint32_t crc15_after(std::uint32_t crc, std::uint32_t bit) noexcept {
  return (crc << 1U & 0x7FFFU) ^ ((bit ^ (crc >> 14U)) != 0 ? 0x4599U : 0U);
}

/// What eight bits do, by the run before them (-4 to 4) and their value.
struct ByteSteps {
  std::array<std::array<Stuffing, 256>, 9> stuffing{};
  std::array<std::uint32_t, 256> crc15{};

  constexpr ByteSteps() noexcept {
    for (std::uint32_t value = 0; value < 256; ++value) {
      std::uint32_t crc = 0;
      for (std::uint32_t bit = 8; bit-- > 0;) crc = crc15_after(crc, value >> bit & 1U);
      crc15[value] = crc;
      for (int run = -4; run <= 4; ++run) {
        Stuffing& step = stuffing[static_cast<std::size_t>(run + 4)][value];
        step.run = run;
        for (std::uint32_t bit = 8; bit-- > 0;) step.put(value >> bit & 1U);
      }
    }
  }
};
constexpr ByteSteps kByteSteps;

class StuffedBits {
 public:
  void put(std::uint64_t value, int bits) noexcept {
    for (; bits >= 8; bits -= 8) put_byte(static_cast<std::uint8_t>(value >> (bits - 8)));
    count_ += bits;
    while (bits-- > 0) {
      const std::uint32_t bit = value >> bits & 1U;
      stuffing_.put(bit);
      crc15_ = crc15_after(crc15_, bit);
    }
  }
  void put_byte(std::uint8_t value) noexcept {
    const Stuffing& step = kByteSteps.stuffing[static_cast<std::size_t>(stuffing_.run + 4)][value];
    stuffing_ = {step.run, stuffing_.stuffed + step.stuffed};
    crc15_ = (crc15_ << 8U & 0x7FFFU) ^ kByteSteps.crc15[crc15_ >> 7U ^ value];
    count_ += 8;
  }
  int count() const noexcept { return count_ + stuffing_.stuffed; }
  /// CRC-15 of what was put so far (polynomial 0x4599), stuff bits left out.
  std::uint32_t crc15() const noexcept { return crc15_; }

 private:
  Stuffing stuffing_;
  std::uint32_t crc15_ = 0;
  int count_ = 0;
};

struct Field {
  std::uint64_t value = 0;
  int bits = 0;

  Field then(std::uint64_t next, int next_bits) const noexcept {
    return {value << next_bits | next, bits + next_bits};
  }
};

/// From the start of frame, a zero, to IDE, or to the remote bit of an extended frame.
Field identifier(const CanFrame& frame, bool remote) noexcept {
  if (!frame.extended) return Field{frame.id & kStandardIdMax, 12}.then(remote ? 0b10 : 0b00, 2);
  const Field base = Field{frame.id >> 18U & kStandardIdMax, 12}.then(0b11, 2);  // SRR, IDE
  return base.then(frame.id & 0x3FFFFU, 18).then(remote ? 1 : 0, 1);
}

void put_data(const CanFrame& frame, StuffedBits* bits) noexcept {
  for (std::size_t i = 0; i < frame.length; ++i) bits->put_byte(frame.data[i]);
}

/// Data length code of a length that an FD frame can have.
std::uint32_t length_code(std::uint32_t length) noexcept {
  if (length <= 8) return length;
  return length <= 24 ? 6 + length / 4 : 11 + length / 16;
}

double fd_frame_time_s(const CanFrame& frame, double bitrate_bps,
                       double data_bitrate_bps) noexcept {
  StuffedBits bits;
  const Field header = identifier(frame, false).then(frame.bitrate_switch ? 0b101 : 0b100, 3);
  bits.put(header.value, header.bits);  // ends with FDF, reserved, bit-rate switch
  const int slow = bits.count();
  bits.put(length_code(frame.length), 5);  // behind the error state indicator, a zero
  put_data(frame, &bits);
  const int fast = bits.count() - slow + kFdStuffCountBits + fd_crc_bits(frame.length);
  return (slow + kTrailerBits) / bitrate_bps +
         fast / (frame.bitrate_switch ? data_bitrate_bps : bitrate_bps);
}

}  // namespace

double worst_frame_time_s(int bytes, bool extended, bool fd, double bitrate_bps,
                          double data_bitrate_bps) noexcept {
  if (!fd) {
    const int n = std::clamp(bytes, 0, 8);
    const int bits = extended ? 67 + 8 * n + (53 + 8 * n) / 4 : 47 + 8 * n + (33 + 8 * n) / 4;
    return bits / bitrate_bps;
  }
  const int n = fd_length(std::clamp(bytes, 0, 64));
  const int header = extended ? 36 : 17;
  const int header_stuff = (header - 1) / 4;
  const int nominal = header + header_stuff + kTrailerBits;
  const int stuff = (header + 4 + 8 * n) / 4 - header_stuff;
  const int data = 5 + 8 * n + stuff + kFdStuffCountBits + fd_crc_bits(n);
  return nominal / bitrate_bps + data / data_bitrate_bps;
}

int classic_frame_bits(const CanFrame& frame) noexcept {
  StuffedBits bits;
  const Field reserved = identifier(frame, frame.remote).then(0, frame.extended ? 2 : 1);
  const Field header = reserved.then(frame.length, 4);
  bits.put(header.value, header.bits);
  if (!frame.remote) put_data(frame, &bits);
  bits.put(bits.crc15(), 15);
  return bits.count() + kTrailerBits;
}

double frame_time_s(const CanFrame& frame, double bitrate_bps, double data_bitrate_bps) noexcept {
  if (frame.error) return 0.0;
  if (frame.fd) return fd_frame_time_s(frame, bitrate_bps, data_bitrate_bps);
  return classic_frame_bits(frame) / bitrate_bps;
}

}  // namespace limber
