#include "drivers/can/frame_time.h"

#include <algorithm>

namespace limber {
namespace {

constexpr int kTrailerBits =
    13;  // CRC delimiter, acknowledge slot and delimiter, end of frame, gap
constexpr int kFdStuffCountBits = 4;  // three bits of count and their parity

/// CRC field of an FD frame, with the stuff bits at its fixed places.
constexpr int fd_crc_bits(int bytes) noexcept { return bytes <= 16 ? 17 + 6 : 21 + 7; }

/// Counts bits as they leave a controller: after five equal ones comes one of the other kind.
class StuffedBits {
 public:
  void put(std::uint32_t value, int bits) noexcept {
    while (bits-- > 0) put_bit((value >> static_cast<unsigned>(bits)) & 1U);
  }
  int count() const noexcept { return count_; }
  /// CRC-15 of what was put so far (polynomial 0x4599), stuff bits left out.
  std::uint32_t crc15() const noexcept { return crc15_; }

 private:
  void put_bit(std::uint32_t bit) noexcept {
    const bool divide = (bit ^ (crc15_ >> 14U)) != 0;
    crc15_ = (crc15_ << 1U & 0x7FFFU) ^ (divide ? 0x4599U : 0U);
    ++count_;
    equal_ = bit == last_ ? equal_ + 1 : 1;
    last_ = bit;
    if (equal_ < 5) return;
    ++count_;
    last_ = 1U - bit;
    equal_ = 1;
  }

  std::uint32_t crc15_ = 0;
  std::uint32_t last_ = 2;  // neither
  int equal_ = 0;
  int count_ = 0;
};

void put_identifier(const CanFrame& frame, bool remote, StuffedBits* bits) noexcept {
  bits->put(0, 1);  // start of frame
  if (!frame.extended) {
    bits->put(frame.id, 11);
    bits->put(remote ? 1 : 0, 1);
    bits->put(0, 1);  // IDE
    return;
  }
  bits->put(frame.id >> 18U, 11);
  bits->put(0b11, 2);  // SRR, IDE
  bits->put(frame.id & 0x3FFFFU, 18);
  bits->put(remote ? 1 : 0, 1);
}

void put_data(const CanFrame& frame, StuffedBits* bits) noexcept {
  for (std::size_t i = 0; i < frame.length; ++i) bits->put(frame.data[i], 8);
}

/// Data length code of a length that an FD frame can have.
std::uint32_t length_code(std::uint32_t length) noexcept {
  if (length <= 8) return length;
  return length <= 24 ? 6 + length / 4 : 11 + length / 16;
}

double fd_frame_time_s(const CanFrame& frame, double bitrate_bps,
                       double data_bitrate_bps) noexcept {
  StuffedBits bits;
  put_identifier(frame, false, &bits);
  bits.put(0b10, 2);  // FDF, reserved
  bits.put(frame.bitrate_switch ? 1 : 0, 1);
  const int slow = bits.count();
  bits.put(0, 1);  // error state indicator
  bits.put(length_code(frame.length), 4);
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
  put_identifier(frame, frame.remote, &bits);
  bits.put(0, frame.extended ? 2 : 1);  // reserved
  bits.put(frame.length, 4);
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
