#include "sim/wire/bus_side.h"

#include <linux/can/error.h>

#include <algorithm>
#include <cmath>

#include "robots/loader/protocols/drive_protocol.h"

namespace limber::sim {
namespace {

std::int64_t rounded_ns(double seconds) noexcept { return std::llround(seconds * 1e9); }

}  // namespace

BusSide::BusSide(CanBus* bus, const BusConfig& config, const WireOptions& options, int nodes,
                 std::uint64_t stream)
    : inbox_(bus),
      adapter_(timing_of(config.adapter)),
      seed_(options.seed * 999'983U + stream),
      random_(seed_) {
  adapter_.send_s += options.delay_s;
  adapter_.receive_s += options.delay_s;
  if (options.on) wire_.emplace(config, options, nodes + 1, stream);
}

void BusSide::accept(const CanFrame& frame, std::int64_t now_ns) noexcept {
  last_accepted_ns_ =
      std::max(last_accepted_ns_, now_ns + rounded_ns(adapter_.send_s) + jitter_ns());
  wire_->send(kDriver, frame, last_accepted_ns_);
}

void BusSide::send(int node, const CanFrame& frame, std::int64_t now_ns) noexcept {
  if (wire_ && !direct_) {
    wire_->send(kDriver + 1 + node, frame, now_ns + rounded_ns(kDriveReplyDelay_s));
  } else {
    send_directly(frame);
  }
}

void BusSide::send_directly(const CanFrame& frame) noexcept {
  outgoing_[num_outgoing_++] = frame;
  if (num_outgoing_ == outgoing_.size()) deliver();
}

void BusSide::deliver() noexcept {
  if (num_outgoing_ > 0) inbox_.bus()->send(std::span(outgoing_).first(num_outgoing_));
  num_outgoing_ = 0;
}

bool BusSide::carry(std::int64_t until_ns, std::int64_t offset_ns, CanFrame* frame,
                    std::int64_t* at_ns) noexcept {
  WireEvent event;
  while (wire_ && wire_->next(until_ns, &event)) {
    if (event.kind != WireEvent::Kind::kFrame) {
      report(event, offset_ns);
    } else if (event.sender == kDriver) {
      *frame = event.frame;
      *at_ns = event.end_ns;
      return true;
    } else {
      to_driver(event.frame, event.end_ns, offset_ns);
    }
  }
  return false;
}

void BusSide::report(const WireEvent& event, std::int64_t offset_ns) noexcept {
  CanFrame error;
  error.error = true;
  switch (event.kind) {
    case WireEvent::Kind::kError:
      error.id = CAN_ERR_PROT;
      break;
    case WireEvent::Kind::kBusOff:
      error.id = event.sender == kDriver ? CAN_ERR_BUSOFF : CAN_ERR_PROT;
      break;
    case WireEvent::Kind::kRestarted:
      if (event.sender != kDriver) return;
      error.id = CAN_ERR_RESTARTED;
      break;
    default:
      return;
  }
  to_driver(error, event.end_ns, offset_ns);
}

void BusSide::to_driver(CanFrame frame, std::int64_t end_ns, std::int64_t offset_ns) noexcept {
  last_delivered_ns_ =
      std::max(last_delivered_ns_, end_ns + rounded_ns(adapter_.receive_s) + jitter_ns());
  frame.timestamp_ns = last_delivered_ns_ + offset_ns;
  send_directly(frame);
}

void BusSide::clear() noexcept {
  if (wire_) wire_->clear();
  random_.seed(seed_);
  last_accepted_ns_ = last_delivered_ns_ = 0;
}

std::int64_t BusSide::jitter_ns() noexcept {
  return rounded_ns(std::uniform_real_distribution<double>(0.0, adapter_.jitter_s)(random_));
}

}  // namespace limber::sim
