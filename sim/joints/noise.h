// Repeatable noise: numbers that depend on their key alone, the same with every standard library.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace limber::sim {

/// Uniform in (0, 1), by the mixing function of SplitMix64 (Steele, Lea and Flood 2014).
inline double uniform(std::uint64_t key) noexcept {
  std::uint64_t z = key + 0x9E3779B97F4A7C15U;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  z ^= z >> 31U;
  return (static_cast<double>(z >> 11U) + 0.5) * 0x1p-53;
}

/// Standard normal (Box and Muller 1958).
inline double gaussian(std::uint64_t key) noexcept {
  return std::sqrt(-2.0 * std::log(uniform(key))) *
         std::cos(2.0 * std::numbers::pi * uniform(~key));
}

}  // namespace limber::sim
