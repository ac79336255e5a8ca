// Tells the user in words when the drives change state, without the cycle ever writing a log line.
#pragma once

#include <atomic>
#include <cstdint>
#include <limber/joint_state_t.hpp>
#include <string>
#include <thread>
#include <vector>

namespace limber {

/// A thread of normal priority that looks at the last state noted and logs what is new.
class StateReporter {
 public:
  /// `joints`: names for messages. Start it before real-time priority is asked for: threads inherit
  /// that.
  explicit StateReporter(std::vector<std::string> joints);
  ~StateReporter();

  /// Allowed inside the cycle.
  void note(const joint_state_t& state) noexcept {
    noted_.store(pack(state.drive_state, state.fault, state.fault_joint) |
                     (state.sensor_state == joint_state_t::SENSOR_ERROR ? kSensorError : 0U),
                 std::memory_order_relaxed);
  }

 private:
  static constexpr std::uint32_t kSensorError = 1U << 24U;
  static std::uint32_t pack(std::int8_t state, std::int8_t fault, std::int8_t joint) noexcept {
    return static_cast<std::uint32_t>(static_cast<std::uint8_t>(state)) |
           static_cast<std::uint32_t>(static_cast<std::uint8_t>(fault)) << 8 |
           static_cast<std::uint32_t>(static_cast<std::uint8_t>(joint)) << 16;
  }
  void report(std::uint32_t packed) const;
  void report_changes(std::uint32_t told, std::uint32_t noted) const;

  std::vector<std::string> joints_;
  std::atomic<std::uint32_t> noted_;
  std::jthread thread_;
};

/// "on", "hold", ...; "controller lost", ... For messages.
std::string drive_state_name(int drive_state);
std::string fault_name(int fault);

}  // namespace limber
