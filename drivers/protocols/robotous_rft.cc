#include "drivers/protocols/robotous_rft.h"

#include <algorithm>
#include <cmath>

namespace limber::robotous_rft {
namespace {

constexpr std::uint8_t kOneSample = 0x0A;
constexpr std::size_t kFirstAxis = 1;
constexpr std::size_t kOverload = 13;
using Data = std::array<std::uint8_t, 2 * kBytes>;

CanFrame empty_frame(std::uint32_t id) noexcept {
  CanFrame frame;
  frame.id = id;
  frame.length = kBytes;
  return frame;
}

bool is_plain(const CanFrame& frame) noexcept {
  return !frame.extended && !frame.remote && !frame.error && !frame.fd && frame.length == kBytes;
}

double counts_per_unit(const Scale& scale, std::size_t axis) noexcept {
  return axis < 3 ? scale.counts_per_N : scale.counts_per_Nm;
}

}  // namespace

CanFrame encode_request(std::uint32_t id) noexcept {
  CanFrame frame = empty_frame(id);
  frame.data[0] = kOneSample;
  return frame;
}

bool decode_request(const CanFrame& frame, std::uint32_t id) noexcept {
  return is_plain(frame) && frame.id == id && frame.data[0] == kOneSample;
}

bool encode_reply(const WrenchReading& reading, const Scale& scale,
                  const std::array<std::uint32_t, 2>& ids,
                  std::array<CanFrame, 2>* frames) noexcept {
  Data data{};
  data[0] = kOneSample;
  for (std::size_t i = 0; i < 6; ++i) {
    const double counts = reading.F[i] * counts_per_unit(scale, i);
    if (!std::isfinite(counts)) return false;
    const auto count =
        static_cast<std::int16_t>(std::lround(std::clamp(counts, -32768.0, 32767.0)));
    const auto raw = static_cast<std::uint16_t>(count);
    data[kFirstAxis + 2 * i] = static_cast<std::uint8_t>(raw >> 8U);
    data[kFirstAxis + 2 * i + 1] = static_cast<std::uint8_t>(raw & 0xFFU);
  }
  data[kOverload] = reading.overload;
  for (std::size_t half = 0; half < 2; ++half) {
    CanFrame& frame = (*frames)[half] = empty_frame(ids[half]);
    std::copy_n(data.begin() + static_cast<std::ptrdiff_t>(half) * kBytes, kBytes,
                frame.data.begin());
  }
  return true;
}

bool decode_reply(const CanFrame& first, const CanFrame& second, const Scale& scale,
                  WrenchReading* reading) noexcept {
  if (!is_plain(first) || !is_plain(second) || first.data[0] != kOneSample) return false;
  Data data{};
  std::copy_n(first.data.begin(), kBytes, data.begin());
  std::copy_n(second.data.begin(), kBytes, data.begin() + kBytes);
  for (std::size_t i = 0; i < 6; ++i) {
    const auto raw =
        static_cast<std::uint16_t>(data[kFirstAxis + 2 * i] << 8U | data[kFirstAxis + 2 * i + 1]);
    reading->F[i] = static_cast<std::int16_t>(raw) / counts_per_unit(scale, i);
  }
  reading->overload = data[kOverload];
  return true;
}

}  // namespace limber::robotous_rft
