// Log lines when the drives change state; the cycle itself never writes one.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <limber/joint_state_t.hpp>
#include <string>
#include <thread>
#include <vector>

#include "common/joints.h"
#include "drivers/drive/drive_warning.h"

namespace limber {

/// A thread of normal priority that logs every change of the state, also one that lasts a cycle.
class StateReporter {
 public:
  /// `joints`: names for messages. Start it before real-time priority is requested: threads inherit
  /// that.
  explicit StateReporter(std::vector<std::string> joints);
  ~StateReporter();
  /// Reports what is left and ends the thread: before what set_fault_text() was given goes.
  void stop();

  /// ArmDriver::fault_text(); set before the first note().
  using FaultText = std::function<std::string(int fault, int joint, std::uint16_t detail)>;
  void set_fault_text(FaultText text) { fault_text_ = std::move(text); }

  /// ArmDriver::warning_text(), likewise.
  using WarningText = std::function<std::string(int motor, const DriveWarning& warning)>;
  void set_warning_text(WarningText text) { warning_text_ = std::move(text); }

  /// Called from the thread when the drives have a new fault, with its code, such as
  /// driver.VELOCITY; for driver.REQUESTED only if it was a controller with a fault of its own that
  /// requested. Set before the first note().
  using OnFault = std::function<void(const char* code)>;
  void set_on_fault(OnFault call) { on_fault_ = std::move(call); }

  /// What motor 0, 1, .. is to be looked at for; a line for each change. Allowed inside the cycle.
  void note_warning(int motor, const DriveWarning& warning) noexcept {
    warnings_[static_cast<std::size_t>(motor)].store(warning, std::memory_order_release);
  }
  /// A command of controller `number` was refused because `holder` has the arm; a line for another
  /// number, one a second at most. Allowed inside the cycle.
  void note_other_controller(std::int64_t number, std::int64_t holder) noexcept {
    holder_.store(holder, std::memory_order_relaxed);
    other_controller_.store(number, std::memory_order_release);
  }
  /// `detail`: ArmDriver::fault_detail(). `controller_fault`: the last command came from a
  /// controller in FAULT. Allowed inside the cycle.
  void note(const joint_state_t& state, std::uint16_t detail = 0,
            bool controller_fault = false) noexcept {
    std::uint64_t packed = pack(state.drive_state, state.fault, state.fault_joint);
    if (state.sensor_state == joint_state_t::SENSOR_ERROR) packed |= kSensorError;
    if (state.fault != last_fault_) {
      fault_detail_ = detail;
      by_controller_ = controller_fault && state.fault == joint_state_t::FAULT_REQUESTED;
    }
    last_fault_ = state.fault;
    if (by_controller_) packed |= kByController;
    queue(packed | std::uint64_t{fault_detail_} << 32U);
  }
  /// This process did nothing for so long: a line. Allowed inside the cycle.
  void note_stall(std::int64_t time_ns) noexcept {
    stall_ns_.store(time_ns, std::memory_order_release);
  }

 private:
  static constexpr std::uint64_t kSensorError = 1U << 24U;
  static constexpr std::uint64_t kByController = 1U << 25U;
  static constexpr std::uint64_t kNothing = ~std::uint64_t{0};
  static constexpr std::size_t kChanges = 64;  ///< room for so many between two rounds

  /// A change that finds no room is queued when there is some.
  void queue(std::uint64_t packed) noexcept {
    const std::size_t next = queued_.load(std::memory_order_relaxed);
    if (packed == last_queued_ || next - taken_.load(std::memory_order_acquire) == kChanges) return;
    changes_[next % kChanges] = packed;
    last_queued_ = packed;
    queued_.store(next + 1, std::memory_order_release);
  }
  static std::uint32_t pack(std::int8_t state, std::int8_t fault, std::int8_t joint) noexcept {
    return static_cast<std::uint32_t>(static_cast<std::uint8_t>(state)) |
           static_cast<std::uint32_t>(static_cast<std::uint8_t>(fault)) << 8 |
           static_cast<std::uint32_t>(static_cast<std::uint8_t>(joint)) << 16;
  }
  void report(std::uint64_t packed, int known_fault) const;
  void report_changes(std::uint64_t reported, std::uint64_t noted) const;
  void report_other_controller();
  void report_stall();

  std::vector<std::string> joints_;
  FaultText fault_text_;
  OnFault on_fault_;
  void report_warnings(std::array<DriveWarning, kMaxMotors>* reported) const;

  static_assert(std::atomic<DriveWarning>::is_always_lock_free);
  WarningText warning_text_;
  std::array<std::atomic<DriveWarning>, kMaxMotors> warnings_{};
  std::int8_t last_fault_ = joint_state_t::FAULT_NONE;
  bool by_controller_ = false;
  std::uint16_t fault_detail_ = 0;  ///< when the fault began
  std::uint64_t last_queued_ = kNothing;
  std::array<std::uint64_t, kChanges> changes_{};
  std::atomic<std::size_t> queued_ = 0;
  std::atomic<std::size_t> taken_ = 0;
  std::atomic<std::int64_t> stall_ns_ = 0;          ///< 0: none to report
  std::atomic<std::int64_t> other_controller_ = 0;  ///< 0: none
  std::atomic<std::int64_t> holder_ = 0;
  std::int64_t controller_told_ = 0;  // of the thread, as the next
  int rounds_until_next_ = 0;
  std::jthread thread_;
};

}  // namespace limber
