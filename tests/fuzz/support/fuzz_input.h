// What a fuzz target makes of its bytes: numbers, frames, the rest. Once the bytes have run out,
// everything is zero.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

#include "drivers/can/can_frame.h"

namespace limber::fuzz {

class FuzzInput {
 public:
  FuzzInput(const std::uint8_t* data, std::size_t size) : left_(data, size) {}

  bool empty() const { return left_.empty(); }
  std::span<const std::uint8_t> rest() const { return left_; }

  /// The next sizeof(Number) bytes, little-endian.
  template <typename Number>
  Number take() {
    Number value{};
    const std::size_t n = std::min(sizeof(Number), left_.size());
    if (n != 0) std::memcpy(&value, left_.data(), n);
    left_ = left_.subspan(n);
    return value;
  }

  /// A number of a sane size: -32.768 to 32.767.
  double small() { return 1e-3 * take<std::int16_t>(); }

  /// flags, identifier (4 bytes), length, data. Any frame that the buses hand on: a possible one.
  CanFrame frame() {
    CanFrame frame;
    const auto flags = take<std::uint8_t>();
    frame.extended = (flags & 1U) != 0;
    frame.remote = (flags & 2U) != 0;
    frame.error = (flags & 4U) != 0;
    frame.fd = (flags & 8U) != 0 && !frame.remote;
    frame.bitrate_switch = frame.fd && (flags & 16U) != 0;
    frame.id = take<std::uint32_t>() & (frame.extended ? kExtendedIdMax : kStandardIdMax);
    const int length = take<std::uint8_t>() % 65;
    frame.length = static_cast<std::uint8_t>(frame.fd ? fd_length(length) : std::min(length, 8));
    const std::size_t carried = frame.remote ? 0 : std::min<std::size_t>(length, frame.length);
    for (std::size_t i = 0; i < carried; ++i) frame.data[i] = take<std::uint8_t>();
    return frame;
  }

 private:
  std::span<const std::uint8_t> left_;
};

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace limber::fuzz
