#include "drivers/can/lockstep_frame.h"

namespace limber::lockstep {
namespace {

CanFrame numbered(std::uint32_t id, std::int64_t seq) noexcept {
  CanFrame frame;
  frame.id = id;
  frame.extended = true;
  frame.length = 8;
  const auto bits = static_cast<std::uint64_t>(seq);
  for (unsigned i = 0; i < 8; ++i) frame.data[i] = static_cast<std::uint8_t>(bits >> (8 * i));
  return frame;
}

bool has_number(const CanFrame& frame, std::uint32_t id) noexcept {
  return frame.id == id && frame.extended && !frame.remote && !frame.error && frame.length == 8;
}

}  // namespace

CanFrame tick(std::int64_t seq) noexcept { return numbered(kTickId, seq); }
CanFrame tock(std::int64_t seq) noexcept { return numbered(kTockId, seq); }

bool is_tick(const CanFrame& frame) noexcept { return has_number(frame, kTickId); }
bool is_tock(const CanFrame& frame) noexcept { return has_number(frame, kTockId); }

std::int64_t sequence(const CanFrame& frame) noexcept {
  std::uint64_t bits = 0;
  for (unsigned i = 0; i < 8; ++i) bits |= static_cast<std::uint64_t>(frame.data[i]) << (8 * i);
  return static_cast<std::int64_t>(bits);
}

}  // namespace limber::lockstep
