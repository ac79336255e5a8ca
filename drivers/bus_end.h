// The driver's end of one bus for one cycle: a batch out, replies in, lock step, load and losses.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "common/joints.h"
#include "drivers/can/can_bus.h"
#include "robots/robot.h"

namespace limber {

/// Everything but the constructor is allowed inside the cycle.
class BusEnd {
 public:
  BusEnd(CanBus* bus, const BusConfig& config) : bus_(bus), config_(config) {}

  bool fd() const noexcept { return config_.fd; }

  /// Every batch shall end with this frame, once, whoever asks for it.
  void end_with(const CanFrame& frame) noexcept { last_ = frame; }

  /// Starts an empty batch.
  void clear() noexcept { batched_ = 0; }
  void add(const CanFrame& frame) noexcept {
    if (last_ && has_id(frame, last_->id)) return;
    put(frame);
  }
  /// Sends the batch. Frames that are not accepted are gone: the next cycle has newer ones.
  void send() noexcept;

  /// Takes what has arrived; false when nothing is waiting.
  std::span<const CanFrame> receive() noexcept;
  /// Counts a frame that nobody expected.
  void count_foreign() noexcept { ++foreign_; }

  // Lock step.
  void expect_tock(std::int64_t seq) noexcept;
  void send_tick() noexcept;
  /// True if the frame belongs to lock step.
  bool take_lockstep(const CanFrame& frame) noexcept;
  bool tocked() const noexcept { return tocked_; }

  /// Frames refused in three cycles in a row, bus-off, or link down.
  bool lost() const noexcept;

  /// Share of the wire taken since the last call, 0..1; `seconds` is the time since.
  void close_interval(double seconds) noexcept;
  double load_counted() const noexcept { return load_; }

  const CanStatistics& statistics() const noexcept { return bus_->statistics(); }
  std::int64_t foreign() const noexcept { return foreign_; }

 private:
  void put(const CanFrame& frame) noexcept {
    if (batched_ < batch_.size()) batch_[batched_++] = frame;
  }
  void count_load(const CanFrame& frame) noexcept;

  CanBus* bus_;
  BusConfig config_;
  std::array<CanFrame, kMaxMotors + 2> batch_;  ///< motors, tip sensor, last_
  std::size_t batched_ = 0;
  std::optional<CanFrame> last_;
  std::array<CanFrame, 32> received_;
  std::int64_t foreign_ = 0;
  int refused_cycles_ = 0;
  std::int64_t tick_ = -1;
  bool tocked_ = false;
  double busy_s_ = 0.0;
  double load_ = 0.0;
};

}  // namespace limber
