#include "drivers/protocols/limber_ft.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace limber::limber_ft {
namespace {

constexpr std::uint8_t kOneSample = 0x0A;
constexpr std::size_t kOverload = 2;
constexpr std::size_t kFirstAxis = 4;

CanFrame empty_frame(std::uint32_t id, int bytes) noexcept {
  CanFrame frame;
  frame.id = id;
  frame.fd = true;
  frame.bitrate_switch = true;
  frame.length = static_cast<std::uint8_t>(bytes);
  frame.data[0] = kOneSample;
  return frame;
}

bool is_plain(const CanFrame& frame, int bytes) noexcept {
  return frame.fd && !frame.extended && !frame.error && frame.length == bytes &&
         frame.data[0] == kOneSample;
}

void put_float(float value, std::uint8_t* bytes) noexcept {
  const auto raw = std::bit_cast<std::uint32_t>(value);
  for (unsigned i = 0; i < 4; ++i) bytes[i] = static_cast<std::uint8_t>(raw >> 8U * i);
}

float get_float(const std::uint8_t* bytes) noexcept {
  std::uint32_t raw = 0;
  for (unsigned i = 0; i < 4; ++i) raw |= static_cast<std::uint32_t>(bytes[i]) << 8U * i;
  return std::bit_cast<float>(raw);
}

}  // namespace

CanFrame encode_request(std::uint32_t id, std::uint8_t counter) noexcept {
  CanFrame frame = empty_frame(id, kRequestBytes);
  frame.data[1] = counter;
  return frame;
}

bool decode_request(const CanFrame& frame, std::uint32_t id, std::uint8_t* counter) noexcept {
  if (!is_plain(frame, kRequestBytes) || frame.id != id) return false;
  *counter = frame.data[1];
  return true;
}

bool encode_reply(const WrenchReading& reading, std::uint8_t counter, std::uint32_t id,
                  CanFrame* frame) noexcept {
  constexpr double kMost = std::numeric_limits<float>::max();
  CanFrame reply = empty_frame(id, kReplyBytes);
  reply.data[1] = counter;
  reply.data[kOverload] = reading.overload;
  for (std::size_t i = 0; i < 6; ++i) {
    if (!std::isfinite(reading.F[i])) return false;
    put_float(static_cast<float>(std::clamp(reading.F[i], -kMost, kMost)),
              &reply.data[kFirstAxis + 4 * i]);
  }
  *frame = reply;
  return true;
}

bool decode_reply(const CanFrame& frame, std::uint8_t* counter, WrenchReading* reading) noexcept {
  if (!is_plain(frame, kReplyBytes)) return false;
  WrenchReading read;
  for (std::size_t i = 0; i < 6; ++i) {
    read.F[i] = static_cast<double>(get_float(&frame.data[kFirstAxis + 4 * i]));
    if (!std::isfinite(read.F[i])) return false;
  }
  read.overload = frame.data[kOverload];
  *counter = frame.data[1];
  *reading = read;
  return true;
}

}  // namespace limber::limber_ft
