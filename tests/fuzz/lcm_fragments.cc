// Fragments of long LCM messages, garbled or not, from four senders: memory is bounded, what
// becomes whole is no longer than it may be, and an honest message in between comes through.
#include "common/lcm_fragments.h"

#include <vector>

#include "tests/fuzz/support/fuzz_input.h"
#include "tests/fuzz/support/require.h"

using namespace limber;

namespace {

using Bytes = std::vector<std::uint8_t>;

void put(Bytes& to, std::uint32_t value, int bytes) {
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8)
    to.push_back(static_cast<std::uint8_t>(value >> shift));
}

Bytes fragment(std::uint32_t sequence, std::uint32_t message_bytes, std::uint32_t offset,
               std::uint16_t number, std::uint16_t count, std::span<const std::uint8_t> rest) {
  Bytes made = {'L', 'C', '0', '3'};
  put(made, sequence, 4);
  put(made, message_bytes, 4);
  put(made, offset, 4);
  put(made, number, 2);
  put(made, count, 2);
  made.insert(made.end(), rest.begin(), rest.end());
  return made;
}

std::optional<LcmDatagram> add(LcmFragments& fragments, std::uint64_t sender, const Bytes& bytes) {
  const auto read = read_lcm_fragment(bytes);
  if (!read) return std::nullopt;
  fuzz::require(read->number < read->count, "its number is one of so many");
  fuzz::require(std::uint64_t{read->offset} + read->part.size() <= read->message_bytes,
                "it lies within its message");
  auto whole = fragments.add(sender, *read);
  fuzz::require(fragments.waiting() <= LcmFragments::kMostWaiting, "memory is bounded");
  if (!whole) return std::nullopt;
  fuzz::require(whole->message.size() == read->message_bytes, "it is as long as it says");
  fuzz::require(whole->message.size() <= kLongestWhole_bytes, "and not too long");
  fuzz::require(whole->channel.size() <= kLongestChannel, "so is its channel");
  return whole;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::FuzzInput in(data, size);
  LcmFragments fragments;
  while (!in.empty()) {
    const auto kind = in.take<std::uint8_t>();
    const std::uint64_t sender = kind % 4;
    const bool large = kind % 64 >= 60;
    const auto number = [&] {
      return large ? in.take<std::uint32_t>() >> in.take<std::uint8_t>() % 32
                   : in.take<std::uint8_t>() % 32U;
    };
    const std::uint32_t sequence = number() % 4, message_bytes = number(), offset = number();
    const auto part = static_cast<std::uint16_t>(number());
    const auto count = static_cast<std::uint16_t>(number());
    Bytes rest(in.take<std::uint8_t>() % 80);
    for (std::uint8_t& byte : rest) byte = in.take<std::uint8_t>();
    add(fragments, sender, fragment(sequence, message_bytes, offset, part, count, rest));
  }
  const Bytes first = {'A', 0, 1, 2}, second = {3};
  add(fragments, 9, fragment(1, 3, 2, 1, 2, second));
  const auto whole = add(fragments, 9, fragment(1, 3, 0, 0, 2, first));
  fuzz::require(whole && whole->channel == "A", "an honest message comes whole");
  fuzz::require(std::ranges::equal(whole->message, Bytes{1, 2, 3}), "as it was sent");
  return 0;
}
