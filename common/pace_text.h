// What a busy machine does to a run, in words.
#pragma once

#include <cstdint>
#include <string>

namespace limber {

/// In real time a process that did nothing for so long tells: shorter pauses are bridged.
inline constexpr std::int64_t kStall_ns = 20'000'000;
/// "limber-sim stood still for 480 ms: this machine was busy elsewhere". Allocates: for messages.
std::string stall_text(const std::string& program, std::int64_t time_ns);

/// "simulated time runs at 34 % of real time (load average 6.2 on 2 processors)"; `share`:
/// simulated seconds in a second of the clock. Allocates: for messages.
std::string pace_text(double share);
/// "26.0 s of arm time took 76.5 s, 34 % of real time (...)", likewise.
std::string length_text(double arm_time_s, double share);

}  // namespace limber
