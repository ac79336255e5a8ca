// A bus end with faults on a script: for tests of drivers and motor nodes. Seeded, so that a run
// repeats itself exactly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "drivers/can/can_bus.h"

namespace limber {

struct BusFault {
  enum class Kind : std::uint8_t {
    kDrop,       ///< lost on the wire: the sender takes it as sent
    kDelay,      ///< handed out `delay_calls` calls of receive() later; received frames only
    kCorrupt,    ///< data[byte] ^= flip; nothing if the frame is shorter
    kDuplicate,  ///< arrives twice
    kRefuse,     ///< send() does not accept it, as with a full queue; sent frames only
    kBusOff,     ///< nothing is sent or received, whatever the identifier
  };
  enum class Direction : std::uint8_t { kSent, kReceived };

  Kind kind = Kind::kDrop;
  Direction direction = Direction::kReceived;
  std::uint32_t id = 0;
  std::uint32_t id_mask =
      0;                     ///< frames with (frame.id & id_mask) == (id & id_mask); 0: every frame
  double probability = 1.0;  ///< per frame
  int delay_calls = 0;
  int byte = 0;
  std::uint8_t flip = 0;
  bool active = true;  ///< from the start, or only after set_active()
};

/// Wears the faults of a list, in order, over another end, which outlives it. Allocates in the
/// constructor only.
class FaultyBus final : public CanBus {
 public:
  using CanBus::send;

  FaultyBus(CanBus* bus, std::vector<BusFault> faults, std::uint64_t seed);

  void set_active(std::size_t fault, bool active) noexcept { faults_[fault].active = active; }
  /// Frames that the fault has struck.
  std::int64_t hits(std::size_t fault) const noexcept { return hits_[fault]; }

  int send(std::span<const CanFrame> frames) noexcept override;
  int receive(std::span<CanFrame> frames) noexcept override;
  /// That of the bus below: it is not readable when a delayed frame falls due.
  int descriptor() const noexcept override { return bus_->descriptor(); }
  const CanStatistics& statistics() const noexcept override { return statistics_; }

 private:
  struct Fate {
    int copies = 1;
    int delay_calls = 0;
    bool refused = false;
  };
  struct Held {
    CanFrame frame;
    std::int64_t due_call = 0;
  };
  bool strikes(std::size_t fault, BusFault::Direction direction, const CanFrame& frame) noexcept;
  Fate judge(BusFault::Direction direction, CanFrame* frame) noexcept;
  bool is_bus_off() noexcept;
  void collect() noexcept;
  void hold(const CanFrame& frame, const Fate& fate) noexcept;
  void copy_carrier_state() noexcept;
  double random() noexcept;

  CanBus* bus_;
  std::vector<BusFault> faults_;
  std::vector<std::int64_t> hits_;
  std::vector<Held> held_;  // in order of arrival; capacity fixed
  std::uint64_t random_state_;
  std::int64_t calls_ = 0;
  CanStatistics statistics_;
};

}  // namespace limber
