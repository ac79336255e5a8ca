// The ring of a black box, of any size, after any sequence of messages: all that a reader finds in
// it was written, what was written last is there, and what is too long is left out.
#include <map>
#include <string>
#include <vector>

#include "common/black_box/event_ring.h"
#include "tests/fuzz/support/fuzz_input.h"
#include "tests/fuzz/support/require.h"

using namespace limber;

namespace {

constexpr std::string_view kSync = "\xED\xA1\xDA\x01";

std::size_t big_endian(std::string_view bytes) {
  std::size_t value = 0;
  for (const char byte : bytes) value = value << 8U | static_cast<std::uint8_t>(byte);
  return value;
}

/// Bytes of 0 to 127: no part of them is a sync word.
std::string content(std::size_t seed, std::size_t size) {
  std::string made(size, '\0');
  for (std::size_t i = 0; i < size; ++i) made[i] = static_cast<char>((31 * seed + 7 * i) & 0x7F);
  return made;
}

/// By event number: channel and data. The file format, read once more.
std::map<std::size_t, std::string> records(std::string_view ring) {
  std::map<std::size_t, std::string> found;
  std::size_t at = 0;
  while (at + EventRing::kHeaderBytes <= ring.size()) {
    const std::string_view header = ring.substr(at, EventRing::kHeaderBytes);
    if (!header.starts_with(kSync)) {
      at += 8;
      continue;
    }
    const std::size_t size = big_endian(header.substr(20, 4)) + big_endian(header.substr(24, 4));
    fuzz::require(at + header.size() + size <= ring.size(), "a record ends within the ring");
    found[big_endian(header.substr(4, 8))] = ring.substr(at + header.size(), size);
    at += (header.size() + size + 7) / 8 * 8;
  }
  return found;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::FuzzInput in(data, size);
  const std::size_t bytes = in.take<std::uint16_t>() % 4096;
  std::vector<std::uint64_t> memory(bytes / 8);  // begins at a multiple of eight
  const std::span<std::uint8_t> ring_bytes(reinterpret_cast<std::uint8_t*>(memory.data()),
                                           8 * memory.size());
  EventRing ring(ring_bytes);
  std::map<std::size_t, std::string> written;
  while (!in.empty()) {
    const std::string channel = content(written.size(), in.take<std::uint8_t>() % 64);
    const std::string message = content(written.size() + 1, in.take<std::uint16_t>() % 700);
    ring.write(channel, 1, {reinterpret_cast<const std::uint8_t*>(message.data()), message.size()});
    const std::size_t length = EventRing::kHeaderBytes + channel.size() + message.size();
    const bool fits = (length + 7) / 8 * 8 <= ring_bytes.size() / 8;
    if (fits) written[written.size()] = channel + message;
    const auto found =
        records({reinterpret_cast<const char*>(ring_bytes.data()), ring_bytes.size()});
    for (const auto& [number, text] : found)
      fuzz::require(written.contains(number) && written[number] == text, "was written so");
    fuzz::require(written.empty() || found.contains(written.size() - 1), "the newest is there");
  }
  return 0;
}
