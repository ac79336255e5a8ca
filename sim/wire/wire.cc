#include "sim/wire/wire.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "drivers/can/frame_time.h"

namespace limber::sim {
namespace {

constexpr std::int64_t kNever_ns = std::numeric_limits<std::int64_t>::max();
constexpr double kErrorFrameBits = 20.0 + 3.0;  // flags, delimiter, inter-frame space
constexpr double kSuspendBits = 8.0;
constexpr double kBusOffBits = 128.0 * 11.0;
constexpr int kPassive = 127;
constexpr int kBusOff = 255;

/// Bits of the arbitration field as a number: the lower one wins.
std::uint32_t arbitration(const CanFrame& frame) noexcept {
  const std::uint32_t remote = frame.remote ? 1U : 0U;
  if (!frame.extended) return frame.id << 21U | remote << 20U;
  // After the base identifier come SRR and IDE, both recessive.
  return (frame.id >> 18U) << 21U | 0b11U << 19U | (frame.id & 0x3FFFFU) << 1U | remote;
}

bool equal(const CanFrame& a, const CanFrame& b) noexcept {
  return a.fd == b.fd && a.length == b.length &&
         std::equal(a.data.begin(), a.data.begin() + a.length, b.data.begin());
}

}  // namespace

std::int64_t Wire::End::ready_ns() const noexcept {
  return size == 0 || back_ns >= 0 ? kNever_ns : std::max(head().ready_ns, not_before_ns);
}

void Wire::End::pop() noexcept {
  first = --size == 0 ? 0 : (first + 1) % queue.size();  // an empty one begins where memory is near
}

Wire::Wire(const BusConfig& bus, const WireOptions& options, int ends, std::uint64_t stream)
    : bus_(bus),
      options_(options),
      ends_(static_cast<std::size_t>(ends)),
      random_(options.seed * 1'000'003U + stream) {}

void Wire::clear() noexcept {
  for (End& end : ends_) {
    end.first = end.size = 0;
    end.errors = 0;
    end.back_ns = -1;
    end.not_before_ns = 0;
  }
}

void Wire::send(int sender, const CanFrame& frame, std::int64_t ready_ns) noexcept {
  End& end = ends_[index(sender)];
  if (end.size == end.queue.size() || end.back_ns >= 0) {
    ++count_.dropped;
    return;
  }
  end.queue[(end.first + end.size++) % end.queue.size()] = {frame, ready_ns};
}

bool Wire::take(int sender, CanFrame* frame) noexcept {
  End& end = ends_[index(sender)];
  if (end.size == 0) return false;
  *frame = end.head().frame;
  end.pop();
  return true;
}

bool Wire::next(std::int64_t until_ns, WireEvent* event) noexcept {
  std::int64_t start_ns = kNever_ns;
  int twin = -1;
  const int sender = arbitrate(&start_ns, &twin);
  if (restart_due(std::min(until_ns, start_ns), event)) return true;
  if (sender < 0) return false;
  End& end = ends_[index(sender)];
  const CanFrame& frame = end.head().frame;
  const double time_s = frame_time_s(frame, bus_.bitrate_bps, bus_.data_bitrate_bps);
  const std::int64_t end_ns = start_ns + std::llround(time_s * 1e9);
  if (end_ns > until_ns) return false;  // asked again later, with the same answer

  const bool collision = twin >= 0 && !equal(frame, ends_[index(twin)].head().frame);
  if (collision || (options_.corruption > 0.0 && random() < options_.corruption)) {
    const std::int64_t error_end_ns = start_ns + (end_ns - start_ns) / 2 + bits_ns(kErrorFrameBits);
    count_.busy_s += static_cast<double>(error_end_ns - start_ns) * 1e-9;
    free_ns_ = error_end_ns;
    fail(sender, error_end_ns, event);
    if (collision) {
      WireEvent ignored;
      fail(twin, error_end_ns, &ignored);
    }
    return true;
  }
  ++count_.frames;
  count_.busy_s += time_s;
  free_ns_ = end_ns;
  const bool lost = options_.loss > 0.0 && random() < options_.loss;
  if (lost) ++count_.lost;
  *event = {lost ? WireEvent::Kind::kLost : WireEvent::Kind::kFrame, sender, frame, end_ns};
  end.errors = std::max(end.errors - 1, 0);
  if (end.errors > kPassive) end.not_before_ns = end_ns + bits_ns(kSuspendBits);
  end.pop();
  if (twin >= 0) ends_[index(twin)].pop();  // both have sent the same bits
  return true;
}

bool Wire::restart_due(std::int64_t until_ns, WireEvent* event) noexcept {
  for (std::size_t i = 0; i < ends_.size(); ++i) {
    End& end = ends_[i];
    if (end.back_ns < 0 || end.back_ns > until_ns) continue;
    *event = {WireEvent::Kind::kRestarted, static_cast<int>(i), {}, end.back_ns};
    end.back_ns = -1;
    end.errors = 0;
    return true;
  }
  return false;
}

int Wire::arbitrate(std::int64_t* start_ns, int* twin) const noexcept {
  std::int64_t first_ns = kNever_ns;
  for (const End& end : ends_) first_ns = std::min(first_ns, end.ready_ns());
  if (first_ns == kNever_ns) return -1;
  *start_ns = std::max(first_ns, free_ns_);
  int winner = -1;
  for (std::size_t i = 0; i < ends_.size(); ++i) {
    if (ends_[i].ready_ns() > *start_ns) continue;
    const int sender = static_cast<int>(i);
    if (winner < 0) {
      winner = sender;
      continue;
    }
    const std::uint32_t mine = arbitration(ends_[i].head().frame);
    const std::uint32_t best = arbitration(ends_[index(winner)].head().frame);
    if (mine == best) *twin = sender;
    if (mine < best) {
      winner = sender;
      *twin = -1;
    }
  }
  return winner;
}

void Wire::fail(int sender, std::int64_t end_ns, WireEvent* event) noexcept {
  End& end = ends_[index(sender)];
  ++count_.errors;
  end.errors += 8;
  *event = {WireEvent::Kind::kError, sender, end.head().frame, end_ns};
  if (end.errors > kPassive) end.not_before_ns = end_ns + bits_ns(kSuspendBits);
  if (end.errors <= kBusOff) return;
  count_.dropped += static_cast<std::int64_t>(end.size);
  end.first = end.size = 0;
  end.back_ns = end_ns + bits_ns(kBusOffBits);
  event->kind = WireEvent::Kind::kBusOff;
}

std::int64_t Wire::bits_ns(double bits) const noexcept {
  return std::llround(bits / bus_.bitrate_bps * 1e9);
}

}  // namespace limber::sim
