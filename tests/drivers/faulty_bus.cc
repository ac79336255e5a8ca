#include "tests/drivers/faulty_bus.h"

#include <algorithm>
#include <array>
#include <utility>

namespace limber {
namespace {
constexpr std::size_t kMostHeld = 1024;
}  // namespace

FaultyBus::FaultyBus(CanBus* bus, std::vector<BusFault> faults, std::uint64_t seed)
    : bus_(bus), faults_(std::move(faults)), hits_(faults_.size()), random_state_(seed) {
  held_.reserve(kMostHeld);
}

int FaultyBus::send(std::span<const CanFrame> frames) noexcept {
  const bool off = is_bus_off();
  int accepted = 0;
  for (const CanFrame& original : frames) {
    CanFrame frame = original;
    const Fate fate = off ? Fate{} : judge(BusFault::Direction::kSent, &frame);
    bool taken = !off && !fate.refused;
    for (int i = 0; taken && i < fate.copies; ++i) taken = bus_->send(frame) == 1;
    accepted += taken ? 1 : 0;
  }
  statistics_.sent += accepted;
  statistics_.send_refused += static_cast<std::int64_t>(frames.size()) - accepted;
  copy_carrier_state();
  return accepted;
}

int FaultyBus::receive(std::span<CanFrame> frames) noexcept {
  ++calls_;
  collect();
  std::size_t taken = 0;
  std::size_t kept = 0;
  for (const Held& held : held_) {
    if (held.due_call <= calls_ && taken < frames.size()) {
      frames[taken++] = held.frame;
    } else {
      held_[kept++] = held;
    }
  }
  held_.resize(kept);
  statistics_.received += static_cast<std::int64_t>(taken);
  copy_carrier_state();
  return static_cast<int>(taken);
}

/// Takes what the bus below has, as long as there is room to hold it back.
void FaultyBus::collect() noexcept {
  std::array<CanFrame, 16> arrived;
  const bool off = is_bus_off();
  while (held_.size() + 2 * arrived.size() <= kMostHeld) {
    const int count = bus_->receive(arrived);
    for (int i = 0; i < count && !off; ++i) {
      CanFrame& frame = arrived[static_cast<std::size_t>(i)];
      const Fate fate = judge(BusFault::Direction::kReceived, &frame);
      hold(frame, fate);
    }
    if (count < static_cast<int>(arrived.size())) break;
  }
}

void FaultyBus::hold(const CanFrame& frame, const Fate& fate) noexcept {
  for (int i = 0; i < fate.copies && held_.size() < kMostHeld; ++i)
    held_.push_back({frame, calls_ + fate.delay_calls});
}

FaultyBus::Fate FaultyBus::judge(BusFault::Direction direction, CanFrame* frame) noexcept {
  Fate fate;
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    const BusFault& fault = faults_[i];
    if (!strikes(i, direction, *frame)) continue;
    ++hits_[i];
    switch (fault.kind) {
      case BusFault::Kind::kDrop:
        fate.copies = 0;
        break;
      case BusFault::Kind::kDelay:
        fate.delay_calls += fault.delay_calls;
        break;
      case BusFault::Kind::kDuplicate:
        fate.copies *= 2;
        break;
      case BusFault::Kind::kRefuse:
        fate.refused = true;
        break;
      case BusFault::Kind::kCorrupt:
        if (fault.byte < frame->length)
          frame->data[static_cast<std::size_t>(fault.byte)] ^= fault.flip;
        break;
      case BusFault::Kind::kBusOff:
        break;
    }
  }
  return fate;
}

bool FaultyBus::strikes(std::size_t fault, BusFault::Direction direction,
                        const CanFrame& frame) noexcept {
  const BusFault& f = faults_[fault];
  if (!f.active || f.direction != direction || ((frame.id ^ f.id) & f.id_mask) != 0) return false;
  return random() < f.probability;
}

bool FaultyBus::is_bus_off() noexcept {
  return std::any_of(faults_.begin(), faults_.end(), [](const BusFault& fault) {
    return fault.active && fault.kind == BusFault::Kind::kBusOff;
  });
}

/// What only the carrier knows.
void FaultyBus::copy_carrier_state() noexcept {
  const CanStatistics& below = bus_->statistics();
  statistics_.error_frames = below.error_frames;
  statistics_.malformed = below.malformed;
  statistics_.overflow = below.overflow;
  statistics_.link_down = below.link_down;
  statistics_.last_errno = below.last_errno;
  statistics_.bus_off = below.bus_off || is_bus_off();
}

/// SplitMix64: the standard library's distributions differ from one implementation to the next.
double FaultyBus::random() noexcept {
  std::uint64_t z = random_state_ += 0x9E3779B97F4A7C15U;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  return static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-53;
}

}  // namespace limber
