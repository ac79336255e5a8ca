// A ring of messages in memory that two processes share: one writes, the other reads. A message
// that was overwritten, or is being written, is never read as one; whatever else stands in the
// memory, nothing outside the ring is touched and every call ends.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace limber {

/// As many states as a controller may miss while this machine pauses it for 50 ms.
inline constexpr std::uint32_t kRingSlots = 64;
inline constexpr std::size_t kRingWords = 184;
inline constexpr std::size_t kLongestInRing = kRingWords * sizeof(std::uint64_t);

/// All of it 0: an empty ring. Messages have numbers from 1 on, modulo 2^32; number n lies in slot
/// n modulo kRingSlots. That the slots' words are atomic costs nothing and leaves no data race.
struct SharedRing {
  struct alignas(64) Slot {
    /// The message's number; one that belongs to another slot while it is being written.
    std::atomic<std::uint32_t> number;
    std::atomic<std::uint32_t> bytes;
    std::array<std::atomic<std::uint64_t>, kRingWords> words;
  };
  alignas(64) std::atomic<std::uint32_t> newest;    ///< number; what a reader sleeps on
  alignas(64) std::atomic<std::uint32_t> sleeping;  ///< the reader wants to be woken
  std::array<Slot, kRingSlots> slots;
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

/// The only writer, see SharedObject. Goes on where one that died has ended. Allowed in the cycle.
class RingWriter {
 public:
  explicit RingWriter(SharedRing* ring) noexcept : ring_(ring), newest_(ring->newest.load()) {}

  /// False if it is longer than kLongestInRing.
  bool write(std::span<const std::uint8_t> message) noexcept {
    if (message.size() > kLongestInRing) return false;
    const std::uint32_t number = newest_ + 1;
    SharedRing::Slot& slot = ring_->slots[number % kRingSlots];
    slot.number.store(newest_, std::memory_order_relaxed);
    // Each release keeps what was stored before it before it: the wrong number above all.
    slot.bytes.store(static_cast<std::uint32_t>(message.size()), std::memory_order_release);
    for (std::size_t i = 0; 8 * i < message.size(); ++i) {
      std::uint64_t word = 0;
      const auto part =
          message.subspan(8 * i).first(std::min<std::size_t>(8, message.size() - 8 * i));
      std::memcpy(&word, part.data(), part.size());
      slot.words[i].store(word, std::memory_order_release);
    }
    slot.number.store(number, std::memory_order_release);
    newest_ = number;
    // Before `sleeping` is looked at, see reader_sleeps().
    ring_->newest.store(number, std::memory_order_seq_cst);
    return true;
  }
  /// After write(): the reader has to be woken.
  bool reader_sleeps() const noexcept {
    return ring_->sleeping.load(std::memory_order_seq_cst) != 0;
  }

 private:
  SharedRing* ring_;
  std::uint32_t newest_;
};

/// Reads what is written after its construction. Allowed in the cycle.
class RingReader {
 public:
  explicit RingReader(const SharedRing* ring) noexcept : ring_(ring), last_(ring->newest.load()) {}

  bool something_waits() const noexcept {
    return ring_->newest.load(std::memory_order_seq_cst) != last_;
  }
  /// The size of the next message, whose bytes are in `room` as far as they fit; -1 if none waits.
  int read(std::span<std::uint8_t> room) noexcept {
    const std::uint32_t newest = ring_->newest.load(std::memory_order_acquire);
    if (newest - last_ > kRingSlots) {
      dropped_ += newest - last_ - kRingSlots;
      last_ = newest - kRingSlots;
    }
    while (last_ != newest) {
      ++last_;
      const int size = copy(last_, room);
      if (size >= 0) return size;
      ++dropped_;
    }
    return -1;
  }
  /// The number read last.
  std::uint32_t last() const noexcept { return last_; }
  /// Messages that were overwritten before or while they were read, or were none.
  std::int64_t dropped() const noexcept { return dropped_; }

 private:
  int copy(std::uint32_t number, std::span<std::uint8_t> room) const noexcept {
    const SharedRing::Slot& slot = ring_->slots[number % kRingSlots];
    if (slot.number.load(std::memory_order_acquire) != number) return -1;
    const std::size_t bytes = slot.bytes.load(std::memory_order_acquire);
    if (bytes > kLongestInRing) return -1;
    const std::size_t wanted = std::min(bytes, room.size());
    for (std::size_t i = 0; 8 * i < wanted; ++i) {
      // Each acquire keeps the number's second reading behind it.
      const std::uint64_t word = slot.words[i].load(std::memory_order_acquire);
      const auto part = room.subspan(8 * i).first(std::min<std::size_t>(8, wanted - 8 * i));
      std::memcpy(part.data(), &word, part.size());
    }
    const bool torn = slot.number.load(std::memory_order_relaxed) != number;
    return torn ? -1 : static_cast<int>(bytes);
  }

  const SharedRing* ring_;
  std::uint32_t last_;
  std::int64_t dropped_ = 0;
};

}  // namespace limber
