// LAWICEL's protocol (CANUSB manual of 2004; Linux' drivers/net/can/slcan): a letter, hexadecimal
// digits, carriage return. tIIIL DD.. and TIIIIIIIIL DD.. are frames with 11 and 29 bits, r and R
// remote ones; a bare return or z, Z confirm, BEL (7) refuses. A time stamp of four digits may
// follow a frame.
#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "common/config_error.h"
#include "drivers/can/serial_codec.h"

namespace limber {
namespace {

constexpr char kReturn = '\r';
constexpr char kBell = '\a';
constexpr std::string_view kDigits = "0123456789ABCDEF";
constexpr std::size_t kStampDigits = 4;
constexpr std::array<std::pair<int, char>, 9> kBitRates = {{{10'000, '0'},
                                                            {20'000, '1'},
                                                            {50'000, '2'},
                                                            {100'000, '3'},
                                                            {125'000, '4'},
                                                            {250'000, '5'},
                                                            {500'000, '6'},
                                                            {800'000, '7'},
                                                            {1'000'000, '8'}}};

/// -1: no hexadecimal digit.
int value_of(char digit) noexcept {
  if (digit >= '0' && digit <= '9') return digit - '0';
  if (digit >= 'A' && digit <= 'F') return digit - 'A' + 10;
  if (digit >= 'a' && digit <= 'f') return digit - 'a' + 10;
  return -1;
}

bool read(std::string_view digits, std::uint32_t* value) noexcept {
  *value = 0;
  for (const char digit : digits) {
    const int one = value_of(digit);
    if (one < 0) return false;
    *value = *value << 4U | static_cast<std::uint32_t>(one);
  }
  return true;
}

/// A line without its return.
bool decode(std::string_view line, CanFrame* frame) noexcept {
  *frame = {};
  const char kind = line.front();
  frame->extended = kind == 'T' || kind == 'R';
  frame->remote = kind == 'r' || kind == 'R';
  if (!frame->extended && kind != 't' && kind != 'r') return false;
  const std::size_t id_digits = frame->extended ? 8 : 3;
  if (line.size() < id_digits + 2) return false;
  const int length = value_of(line[id_digits + 1]);
  if (length < 0 || length > 8 || !read(line.substr(1, id_digits), &frame->id)) return false;
  frame->length = static_cast<std::uint8_t>(length);
  const std::string_view data = line.substr(id_digits + 2);
  const std::size_t wanted = frame->remote ? 0 : 2 * static_cast<std::size_t>(length);
  if (data.size() != wanted && data.size() != wanted + kStampDigits) return false;
  for (std::size_t i = 0; 2 * i < wanted; ++i) {
    std::uint32_t byte = 0;
    if (!read(data.substr(2 * i, 2), &byte)) return false;
    frame->data[i] = static_cast<std::uint8_t>(byte);
  }
  return is_possible(*frame);
}

class SlcanCodec final : public SerialCodec {
 public:
  std::vector<SerialGreeting> greetings(int bitrate_bps) const override {
    const auto* const rate =
        std::ranges::find(kBitRates, bitrate_bps, &std::pair<int, char>::first);
    const std::string words = "a bit rate of " + std::to_string(bitrate_bps) + " bit/s";
    if (rate == kBitRates.end())
      throw ConfigError("slcan adapters have no " + words.substr(2) +
                        ": 10, 20, 50, 100, 125, 250, 500, 800 or 1000 kbit/s");
    return {{"\r\rC\r", "the end of an earlier use", true},
            {std::string("S") + rate->second + kReturn, words},
            {"O\r", "its CAN side to open"}};
  }

  std::string farewell() const override { return "C\r"; }

  std::size_t encode(const CanFrame& frame, std::span<std::uint8_t> out) const noexcept override {
    std::size_t size = 0;
    const auto put = [&](char letter) { out[size++] = static_cast<std::uint8_t>(letter); };
    put(frame.extended ? (frame.remote ? 'R' : 'T') : (frame.remote ? 'r' : 't'));
    for (unsigned digit = frame.extended ? 8 : 3; digit-- > 0;)
      put(kDigits[frame.id >> (4 * digit) & 0xFU]);
    put(kDigits[frame.length]);
    for (std::size_t i = 0; !frame.remote && i < frame.length; ++i) {
      put(kDigits[frame.data[i] >> 4U]);
      put(kDigits[frame.data[i] & 0xFU]);
    }
    put(kReturn);
    return size;
  }

  SerialEvent take(std::uint8_t byte, CanFrame* frame) noexcept override {
    const char letter = static_cast<char>(byte);
    if (letter != kReturn && letter != kBell) {
      if (size_ < line_.size()) line_[size_] = letter;
      ++size_;  // a line that is too long is damaged, and ends with its return
      return SerialEvent::kNothing;
    }
    const std::size_t size = std::exchange(size_, 0);
    if (letter == kBell) return SerialEvent::kRefused;
    if (size == 0) return SerialEvent::kNothing;
    if (size == 1 && (line_[0] == 'z' || line_[0] == 'Z')) return SerialEvent::kNothing;
    const bool whole = size <= line_.size() && decode({line_.data(), size}, frame);
    return whole ? SerialEvent::kFrame : SerialEvent::kGarbage;
  }

  void reset() noexcept override { size_ = 0; }

 private:
  std::array<char, kLongest> line_{};
  std::size_t size_ = 0;
};

}  // namespace

std::unique_ptr<SerialCodec> make_slcan_codec() { return std::make_unique<SlcanCodec>(); }

}  // namespace limber
