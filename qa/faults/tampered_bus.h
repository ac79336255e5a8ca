// The driver's end of a bus, with a fault between it and the wire.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "drivers/can/can_bus.h"

namespace limber::faults {

/// Not for the cycle of a real arm: it allocates.
class TamperedBus final : public CanBus {
 public:
  using CanBus::send;
  /// Puts what arrives in the place of a received frame into `instead`.
  using Change = std::function<void(const CanFrame& frame, std::vector<CanFrame>* instead)>;

  /// `bus` outlives this.
  explicit TamperedBus(CanBus* bus) : bus_(bus) {}

  void set_change(Change change) { change_ = std::move(change); }
  /// What leaves in the place of a sent frame; none: it is lost, without the sender's knowledge.
  using SentChange = std::function<std::optional<CanFrame>(const CanFrame& frame)>;
  void set_sent_change(SentChange change) { sent_change_ = std::move(change); }
  /// The next frame sent with this identifier is replaced.
  void replace_sent(std::function<bool(const CanFrame&)> which, const CanFrame& frame) {
    replaced_ = std::move(which);
    replacement_ = frame;
  }
  /// The frame arrives with the next release().
  void hold(const CanFrame& frame) { held_.push_back(frame); }
  void release();
  /// From now on no frame is accepted for sending, as with a full queue.
  void refuse_sends() { refuses_ = true; }
  void set_bus_off() { statistics_.bus_off = true; }
  void set_link_down() { statistics_.link_down = true; }

  int send(std::span<const CanFrame> frames) noexcept override;
  int receive(std::span<CanFrame> frames) noexcept override;
  int descriptor() const noexcept override { return bus_->descriptor(); }
  const CanStatistics& statistics() const noexcept override { return statistics_; }

 private:
  bool cut_off() const noexcept { return statistics_.bus_off || statistics_.link_down; }
  bool pass_on(const CanFrame& frame) noexcept;
  void update_statistics() noexcept;

  CanBus* bus_;
  Change change_;
  SentChange sent_change_;
  std::function<bool(const CanFrame&)> replaced_;
  std::optional<CanFrame> replacement_;
  std::vector<CanFrame> held_;
  std::vector<CanFrame> arrived_;
  bool refuses_ = false;
  std::int64_t refused_ = 0;
  CanStatistics statistics_;
};

}  // namespace limber::faults
