// The nodes' side of one bus of the arm: straight, or through an adapter and a wire that take time.
#pragma once

#include <array>
#include <optional>
#include <random>

#include "drivers/can/can_bus.h"
#include "robots/loader/adapter.h"
#include "sim/wire/inbox.h"
#include "sim/wire/wire.h"

namespace limber::sim {

/// After construction allowed in the cycle. Simulated time, ns.
///
/// With a wire, what the driver sends waits in its adapter until time passes: carry() hands it to
/// the nodes when it has left the wire, and passes to the driver what the nodes have sent, stamped
/// with the time at which the driver's adapter has it.
class BusSide {
 public:
  /// `nodes`: senders beside the driver. `bus` outlives this.
  BusSide(CanBus* bus, const BusConfig& config, const WireOptions& options, int nodes,
          std::uint64_t stream);

  bool has_wire() const noexcept { return wire_.has_value(); }
  /// A frame from the driver's side, nullptr when none waits; valid until the next call.
  const CanFrame* next() noexcept { return inbox_.next(); }
  /// With a wire: the driver's adapter takes the frame at this time.
  void accept(const CanFrame& frame, std::int64_t now_ns) noexcept;
  /// A node (from 0) sends a frame at this time.
  void send(int node, const CanFrame& frame, std::int64_t now_ns) noexcept;
  /// Until the next call, what nodes send goes to the driver directly.
  void set_direct(bool direct) noexcept { direct_ = direct; }
  /// To the driver with the next deliver(), without a stamp.
  void send_directly(const CanFrame& frame) noexcept;
  /// Sends what waits for the driver, many frames in one system call.
  void deliver() noexcept;

  /// The next frame that reaches the nodes not later than until_ns, and when. False: none, and the
  /// driver has been sent all that has left the wire until then. Stamps are simulated time plus
  /// `offset_ns`.
  bool carry(std::int64_t until_ns, std::int64_t offset_ns, CanFrame* frame,
             std::int64_t* at_ns) noexcept;
  /// A frame of the driver's that waits in its adapter is taken out, without time; false: none.
  bool take_waiting(CanFrame* frame) noexcept { return wire_->take(kDriver, frame); }
  /// A driver begins: nothing is under way, and its adapter's times vary as from the start,
  /// whatever was sent before time ran.
  void clear() noexcept;

  const Wire* wire() const noexcept { return wire_ ? &*wire_ : nullptr; }

 private:
  static constexpr int kDriver = 0;

  void report(const WireEvent& event, std::int64_t offset_ns) noexcept;
  void to_driver(CanFrame frame, std::int64_t end_ns, std::int64_t offset_ns) noexcept;
  std::int64_t jitter_ns() noexcept;

  Inbox inbox_;
  std::array<CanFrame, 32> outgoing_;
  std::size_t num_outgoing_ = 0;
  AdapterTiming adapter_;
  std::optional<Wire> wire_;
  bool direct_ = false;
  std::uint64_t seed_;
  std::mt19937_64 random_;
  std::int64_t last_accepted_ns_ = 0;   // an adapter keeps the order
  std::int64_t last_delivered_ns_ = 0;  // likewise
};

}  // namespace limber::sim
