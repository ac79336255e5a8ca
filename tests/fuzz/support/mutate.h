// A byte string changed at random: bits, bytes, numbers that readers stumble over, pieces moved,
// left out, doubled, or taken from another input.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

namespace limber::fuzz {

using Bytes = std::vector<std::uint8_t>;

/// Longest result.
inline constexpr std::size_t kMostBytes = 1U << 16U;

/// One to eight changes. The same state of `random` gives the same result.
Bytes mutate(Bytes input, const Bytes& other, std::mt19937_64& random);

}  // namespace limber::fuzz
