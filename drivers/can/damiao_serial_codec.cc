// Damiao's USB-to-CAN adapter (maker's DM_CAN.py and its C++ sample): to it 30 bytes,
//   55 AA 1E 03 | times u32 = 1 | interval u32 = 10 | 29 bits | id u32 | remote | length | 0 0 |
//   data 8 | 0
// from it 16 bytes, little-endian:
//   AA | what | length (6 bits), 29 bits (bit 6), remote (bit 7) | id u32 | data 8 | 55
#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "drivers/can/serial_codec.h"

namespace limber {
namespace {

constexpr std::size_t kSent = 30;
constexpr std::size_t kAnswer = 16;
constexpr std::uint8_t kHead = 0xAA;
constexpr std::uint8_t kTail = 0x55;
constexpr std::uint8_t kReceived = 0x11;
constexpr std::uint8_t kNotSent = 0x02;
/// Heartbeat; not received, received; not sent, sent; bit rate not set, set; error.
constexpr std::array<std::uint8_t, 8> kWhats = {0x00, 0x01, kReceived, kNotSent,
                                                0x12, 0x03, 0x13,      0xEE};
constexpr std::uint8_t kLengthBits = 0x3F;
constexpr std::uint8_t kExtendedBit = 0x40;
constexpr std::uint8_t kRemoteBit = 0x80;

class DamiaoSerialCodec final : public SerialCodec {
 public:
  std::vector<SerialGreeting> greetings(int /*bitrate_bps*/) const override { return {}; }
  std::string farewell() const override { return {}; }

  std::size_t encode(const CanFrame& frame, std::span<std::uint8_t> out) const noexcept override {
    const std::array<std::uint8_t, kSent> form = {0x55, 0xAA, 0x1E, 0x03, 1, 0, 0, 0, 10};
    std::ranges::copy(form, out.begin());
    out[12] = frame.extended ? 1 : 0;
    for (unsigned i = 0; i < 4; ++i) out[13 + i] = static_cast<std::uint8_t>(frame.id >> (8 * i));
    out[17] = frame.remote ? 1 : 0;
    out[18] = frame.length;
    std::memcpy(&out[21], frame.data.data(), 8);
    return kSent;
  }

  SerialEvent take(std::uint8_t byte, CanFrame* frame) noexcept override {
    answer_[size_++] = byte;
    if (size_ == 1 && byte != kHead) return skip();
    if (size_ < kAnswer) return SerialEvent::kNothing;
    const bool known = std::ranges::find(kWhats, answer_[1]) != kWhats.end();
    if (answer_.back() != kTail || !known || !decode(frame)) return skip();
    size_ = 0;
    lost_ = false;
    if (answer_[1] == kNotSent) return SerialEvent::kRefused;
    return answer_[1] == kReceived ? SerialEvent::kFrame : SerialEvent::kNothing;
  }

  void reset() noexcept override {
    size_ = 0;
    lost_ = false;
  }

 private:
  /// Goes on at the next byte that may begin an answer. Counts once, however many bytes it takes.
  SerialEvent skip() noexcept {
    const auto end = answer_.begin() + static_cast<std::ptrdiff_t>(size_);
    const auto next = std::find(answer_.begin() + 1, end, kHead);
    size_ = static_cast<std::size_t>(std::copy(next, end, answer_.begin()) - answer_.begin());
    return std::exchange(lost_, true) ? SerialEvent::kNothing : SerialEvent::kGarbage;
  }

  bool decode(CanFrame* frame) const noexcept {
    *frame = {};
    const std::uint8_t flags = answer_[2];
    frame->extended = (flags & kExtendedBit) != 0;
    frame->remote = (flags & kRemoteBit) != 0;
    frame->length = flags & kLengthBits;
    for (unsigned i = 0; i < 4; ++i)
      frame->id |= static_cast<std::uint32_t>(answer_[3 + i]) << (8 * i);
    std::memcpy(frame->data.data(), &answer_[7], 8);
    return frame->length <= 8 && is_possible(*frame);
  }

  std::array<std::uint8_t, kAnswer> answer_{};
  std::size_t size_ = 0;
  bool lost_ = false;  ///< bytes have been skipped since the last whole answer
};

}  // namespace

std::unique_ptr<SerialCodec> make_damiao_serial_codec() {
  return std::make_unique<DamiaoSerialCodec>();
}

}  // namespace limber
