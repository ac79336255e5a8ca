// Joint numbering shared by every process.
#pragma once

namespace limber {

/// Most joints one arm may have; the fixed-size arrays of the full-rate messages have this length.
inline constexpr int kMaxJoints = 16;
/// Most buses one arm may be spread over.
inline constexpr int kMaxBuses = 4;

}  // namespace limber
