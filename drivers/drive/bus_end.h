// The driver's end of one bus: the cycle's batch out, replies in, lock step, load and losses.
#pragma once

#include <array>
#include <cstdint>
#include <limber/driver_status_t.hpp>
#include <optional>
#include <span>

#include "common/joints.h"
#include "drivers/can/can_bus.h"
#include "robots/loader/robot.h"

namespace limber {

/// Everything but the constructor is allowed inside the cycle.
class BusEnd {
 public:
  /// `load_predicted`: share of the wire, 0..1, for the status. `bus` outlives this.
  BusEnd(CanBus* bus, const BusConfig& config, double load_predicted)
      : bus_(bus), config_(config), load_predicted_(load_predicted) {}

  /// Every batch ends with this frame; frames added with its identifier are left out.
  void end_with(const CanFrame& frame) noexcept { last_ = frame; }

  /// Starts an empty batch.
  void clear() noexcept {
    batched_ = 0;
    question_.reset();
  }
  void add(const CanFrame& frame) noexcept {
    if (last_ && has_id(frame, last_->id)) return;
    put(frame);
  }
  /// Goes behind the cycle's last frame. If it is not accepted it is gone.
  void ask(const CanFrame& question) noexcept { question_ = question; }
  /// Sends the batch. Frames that are not accepted are gone: the next cycle has newer ones, and
  /// begins with the first of them, so that a queue too short for all does not starve always the
  /// same motors. Without a refusal the order is that of add(). The last frame stays the last.
  void send() noexcept;

  /// A batch of what has arrived; empty when nothing is waiting. Valid until the next call. Frames
  /// stamped later than `until_ns` wait for a later call (lock step: a simulated wire delivers a
  /// whole period at once); a stamp more than a second later is another clock's and does not count.
  std::span<const CanFrame> receive(std::int64_t until_ns) noexcept;
  /// False if nothing was left behind the last batch.
  bool more() const noexcept { return more_; }
  /// See CanBus. Set-up only.
  void set_receive_filters(std::span<const CanFilter> filters) {
    bus_->set_receive_filters(filters);
  }
  /// Counts a frame of no drive or sensor of this arm.
  void count_foreign() noexcept { ++foreign_; }

  // Lock step.
  void expect_tock(std::int64_t seq) noexcept;
  void send_tick() noexcept;
  /// True if the frame belongs to lock step.
  bool take_lockstep(const CanFrame& frame) noexcept;
  bool tocked() const noexcept { return tocked_; }

  /// BUS_* of driver_status_t. QUEUE_FULL: in three cycles in a row frames were refused, or those
  /// of the cycle before still waited in the queue.
  std::int8_t state() const noexcept;
  bool lost() const noexcept { return state() != driver_status_t::BUS_GOOD; }

  /// Ends the interval over which the load is counted; `seconds`: its length.
  void close_interval(double seconds) noexcept;
  const std::string& name() const noexcept { return config_.name; }
  /// What was exchanged before, such as a roll call, does not count in the status. Set-up only.
  void count_from_here() noexcept {
    sent_before_ = bus_->statistics().sent;
    received_before_ = bus_->statistics().received;
  }
  /// The fields of bus b.
  void write_status(std::size_t b, driver_status_t* status) const noexcept;

 private:
  void put(const CanFrame& frame) noexcept {
    if (batched_ < batch_.size()) batch_[batched_++] = frame;
  }
  void count_load(const CanFrame& frame) noexcept;
  std::size_t take_held(std::int64_t until_ns) noexcept;

  CanBus* bus_;
  BusConfig config_;
  double load_predicted_;
  /// Motors, up to three requests of each, tip sensor, last_, question_.
  std::array<CanFrame, 4 * kMaxMotors + 3> batch_;
  std::size_t batched_ = 0;
  std::optional<CanFrame> last_;
  std::optional<CanFrame> question_;
  std::array<CanFrame, 32> received_;
  std::array<CanFrame, 128> held_;  ///< in order of arrival
  std::size_t num_held_ = 0;
  bool more_ = false;
  std::int64_t foreign_ = 0;
  std::size_t first_ = 0;  ///< of the batch, in the order of add(), that is sent first
  std::int64_t refused_cycles_ = 0;
  std::int64_t sent_before_ = 0;  ///< before count_from_here(), and TICKs; as the next, and TOCKs
  std::int64_t received_before_ = 0;
  std::int64_t unsent_cycles_ = 0;
  std::int64_t tick_ = -1;
  bool tocked_ = false;
  double busy_s_ = 0.0;
  double load_counted_ = 0.0;  ///< share of the wire in the last interval, 0..1
};

}  // namespace limber
