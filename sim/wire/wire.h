// One CAN bus in simulated time: bit rates, arbitration, exact frame lengths, errors.
//
//   frame time     frame_time_s(): stuff bits, CRC and the three bits of inter-frame space counted
//   arbitration    when the wire is free, the lowest identifier among the frames that are ready
//   order          an end sends one frame after the other: a waiting frame holds up the ones behind
//   corruption     half the frame, an error frame of 20 bits and the inter-frame space, then again;
//                  the sender's transmit error counter rises by 8 and falls by 1 with each frame
//                  that arrives; above 127 the sender is error-passive and waits 8 bits longer,
//                  above 255 it is bus-off for 128 x 11 bits and loses what waits
// (ISO 11898-1.) Two ends that send the same identifier at the same time destroy each other's
// frame unless the frames are equal.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "drivers/can/can_frame.h"
#include "robots/loader/robot.h"
#include "scenarios/loader/scenario.h"

namespace limber::sim {

/// A frame that has left the wire, or an error on it.
struct WireEvent {
  enum class Kind : std::uint8_t { kFrame, kLost, kError, kBusOff, kRestarted };
  Kind kind = Kind::kFrame;
  int sender = 0;
  CanFrame frame;
  std::int64_t end_ns = 0;
};

struct WireCount {
  std::int64_t frames = 0;
  std::int64_t errors = 0;
  std::int64_t lost = 0;
  std::int64_t dropped = 0;  ///< found the sender's queue full, or the sender bus-off
  double busy_s = 0.0;       ///< error frames and repetitions included
};

/// Simulated time throughout, ns. After construction allowed in the cycle.
class Wire {
 public:
  static constexpr int kQueue = 64;  ///< frames that may wait at one end

  /// `ends`: transmitters, 0 to ends - 1.
  Wire(const BusConfig& bus, const WireOptions& options, int ends, std::uint64_t stream);

  /// Puts a frame at the end of a sender's queue; it takes part in arbitration from `ready_ns` on.
  void send(int sender, const CanFrame& frame, std::int64_t ready_ns) noexcept;
  /// The next event not later than until_ns; false if there is none. Events come in order of time.
  bool next(std::int64_t until_ns, WireEvent* event) noexcept;
  /// Takes a waiting frame out of a sender's queue, without time; false: none.
  bool take(int sender, CanFrame* frame) noexcept;
  /// Everything that waits is gone, and every sender is error-active.
  void clear() noexcept;

  const WireCount& count() const noexcept { return count_; }
  int transmit_errors(int sender) const noexcept { return ends_[index(sender)].errors; }

 private:
  struct Waiting {
    CanFrame frame;
    std::int64_t ready_ns = 0;
  };
  struct End {
    std::array<Waiting, kQueue> queue;
    std::size_t first = 0;
    std::size_t size = 0;
    int errors = 0;
    std::int64_t back_ns = -1;       ///< bus-off until then; -1: on the bus
    std::int64_t not_before_ns = 0;  ///< error-passive: suspended after its own frame

    const Waiting& head() const noexcept { return queue[first]; }
    std::int64_t ready_ns() const noexcept;
    void pop() noexcept;
  };

  static std::size_t index(int sender) noexcept { return static_cast<std::size_t>(sender); }
  bool restart_due(std::int64_t until_ns, WireEvent* event) noexcept;
  /// The sender that wins the wire at the earliest time; -1 if none waits. `twin`: another one with
  /// the same identifier.
  int arbitrate(std::int64_t* start_ns, int* twin) const noexcept;
  void fail(int sender, std::int64_t end_ns, WireEvent* event) noexcept;
  std::int64_t bits_ns(double bits) const noexcept;
  double random() noexcept { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }

  BusConfig bus_;
  WireOptions options_;
  std::vector<End> ends_;
  std::mt19937_64 random_;
  std::int64_t free_ns_ = 0;
  WireCount count_;
};

}  // namespace limber::sim
