#include "common/black_box/event_ring.h"

#include <algorithm>
#include <bit>
#include <concepts>
#include <cstring>

namespace limber {
namespace {

constexpr std::uint32_t kSync = 0xEDA1DA01;

template <std::integral Value>
std::uint8_t* put(std::uint8_t* out, Value value) noexcept {
  for (int shift = 8 * (static_cast<int>(sizeof value) - 1); shift >= 0; shift -= 8)
    *out++ = static_cast<std::uint8_t>(value >> shift);
  return out;
}

void set_sync(std::uint8_t* record, std::uint32_t value) noexcept {
  static_assert(std::endian::native == std::endian::little);
  std::atomic_ref(*reinterpret_cast<std::uint32_t*>(record))
      .store(__builtin_bswap32(value), std::memory_order_release);
}

}  // namespace

void EventRing::write(std::string_view channel, std::int64_t time_us,
                      std::span<const std::uint8_t> data) noexcept {
  const std::size_t size = (kHeaderBytes + channel.size() + data.size() + 7) / 8 * 8;
  const std::size_t room = bytes_.size() / 8 * 8;
  if (size > room / 8) return;
  std::uint64_t start = next_.load(std::memory_order_relaxed);
  std::size_t gap = 0;
  do {
    const std::size_t to_end = room - start % room;
    gap = to_end < size ? to_end : 0;
  } while (!next_.compare_exchange_weak(start, start + gap + size, std::memory_order_relaxed));
  std::memset(bytes_.data() + start % room, 0, gap);

  std::uint8_t* record = bytes_.data() + (start + gap) % room;
  set_sync(record, 0);
  std::uint8_t* end = put(record + sizeof kSync, number_.fetch_add(1, std::memory_order_relaxed));
  end = put(end, time_us);
  end = put(end, static_cast<std::int32_t>(channel.size()));
  end = put(end, static_cast<std::int32_t>(data.size()));
  end = std::ranges::copy(channel, end).out;
  std::ranges::copy(data, end);
  set_sync(record, kSync);
}

}  // namespace limber
