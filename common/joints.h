// Joint numbering shared by every process.
#pragma once

namespace limber {

/// Most joints one arm may have; the fixed-size arrays of the full-rate messages have this length.
inline constexpr int kMaxJoints = 16;
/// Two for every joint, at most.
inline constexpr int kMaxMotors = 2 * kMaxJoints;
/// Most buses one arm may be spread over.
inline constexpr int kMaxBuses = 4;

}  // namespace limber
