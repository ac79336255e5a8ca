// A ring of messages in memory that processes share: one writes, any number read. A message that
// was overwritten, or is being written, is never read as one, and each carries a check, so that
// what was scribbled into it isn't either; whatever else stands in the memory, nothing outside the
// ring is touched and every call ends.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace limber {

/// All of it 0: an empty ring. Messages have numbers from 1 on, modulo 2^32; number n lies in slot
/// n modulo kSlots, a power of two. That the slots' words are atomic costs nothing and leaves no
/// data race.
template <std::uint32_t slots_, std::size_t words_>
struct SharedRing {
  static constexpr std::uint32_t kSlots = slots_;
  static constexpr std::size_t kLongest = words_ * sizeof(std::uint64_t);  ///< bytes of a message
  static_assert((kSlots & (kSlots - 1)) == 0);

  struct alignas(64) Slot {
    /// The message's number; one that belongs to another slot while it is being written.
    std::atomic<std::uint32_t> number;
    std::atomic<std::uint32_t> bytes;
    std::atomic<std::uint64_t> check;  ///< RingCheck over number, size and words
    std::array<std::atomic<std::uint64_t>, words_> words;
  };
  alignas(64) std::atomic<std::uint32_t> newest;  ///< number; what a reader may sleep on
  std::array<Slot, kSlots> slots;
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

/// Finds memory that was damaged, not one who forges: each step is a bijection of what was before
/// and of the word, so that one word that differs always changes the result, and anything else does
/// but for one time in 2^64. Allowed in the cycle.
class RingCheck {
 public:
  RingCheck(std::uint32_t number, std::size_t bytes) noexcept {
    add(std::uint64_t{number} << 32U | static_cast<std::uint32_t>(bytes));
  }
  void add(std::uint64_t word) noexcept {
    state_ = (state_ ^ word) * 0x9E3779B97F4A7C15U;
    state_ ^= state_ >> 32U;
  }
  std::uint64_t value() const noexcept { return state_; }

 private:
  std::uint64_t state_ = 0x6C696D626572;  // memory that is all 0 is no message
};

/// The only writer, see SharedObject. Goes on where one that died has ended. Allowed in the cycle.
template <typename Ring>
class RingWriter {
 public:
  explicit RingWriter(Ring* ring) noexcept : ring_(ring), newest_(ring->newest.load()) {}

  /// False if it is longer than Ring::kLongest. Stored before anything that the writer loads after
  /// it, such as whether a reader sleeps.
  bool write(std::span<const std::uint8_t> message) noexcept {
    if (message.size() > Ring::kLongest) return false;
    const std::uint32_t number = newest_ + 1;
    typename Ring::Slot& slot = ring_->slots[number % Ring::kSlots];
    slot.number.store(newest_, std::memory_order_relaxed);
    // Each release keeps what was stored before it before it: the wrong number above all.
    slot.bytes.store(static_cast<std::uint32_t>(message.size()), std::memory_order_release);
    RingCheck check(number, message.size());
    for (std::size_t i = 0; 8 * i < message.size(); ++i) {
      std::uint64_t word = 0;
      const auto part =
          message.subspan(8 * i).first(std::min<std::size_t>(8, message.size() - 8 * i));
      std::memcpy(&word, part.data(), part.size());
      slot.words[i].store(word, std::memory_order_release);
      check.add(word);
    }
    slot.check.store(check.value(), std::memory_order_release);
    slot.number.store(number, std::memory_order_release);
    newest_ = number;
    ring_->newest.store(number, std::memory_order_seq_cst);
    return true;
  }

 private:
  Ring* ring_;
  std::uint32_t newest_;
};

/// Reads what is written after its construction. Allowed in the cycle.
template <typename Ring>
class RingReader {
 public:
  explicit RingReader(const Ring* ring) noexcept : ring_(ring), last_(ring->newest.load()) {}

  bool something_waits() const noexcept {
    return ring_->newest.load(std::memory_order_seq_cst) != last_;
  }
  /// The size of the next message, whose bytes are in `room` as far as they fit; -1 if none waits.
  int read(std::span<std::uint8_t> room) noexcept {
    const std::uint32_t newest = ring_->newest.load(std::memory_order_acquire);
    if (newest - last_ > Ring::kSlots) {
      dropped_ += newest - last_ - Ring::kSlots;
      last_ = newest - Ring::kSlots;
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
  /// Messages that were overwritten before or while they were read, damaged, or were none.
  std::int64_t dropped() const noexcept { return dropped_; }

 private:
  int copy(std::uint32_t number, std::span<std::uint8_t> room) const noexcept {
    const typename Ring::Slot& slot = ring_->slots[number % Ring::kSlots];
    if (slot.number.load(std::memory_order_acquire) != number) return -1;
    const std::size_t bytes = slot.bytes.load(std::memory_order_acquire);
    if (bytes > Ring::kLongest) return -1;
    RingCheck check(number, bytes);
    for (std::size_t i = 0; 8 * i < bytes; ++i) {
      // Each acquire keeps the number's second reading behind it.
      const std::uint64_t word = slot.words[i].load(std::memory_order_acquire);
      check.add(word);
      if (8 * i >= room.size()) continue;
      const auto part =
          room.subspan(8 * i).first(std::min<std::size_t>(8, std::min(bytes, room.size()) - 8 * i));
      std::memcpy(part.data(), &word, part.size());
    }
    if (slot.check.load(std::memory_order_acquire) != check.value()) return -1;
    const bool torn = slot.number.load(std::memory_order_relaxed) != number;
    return torn ? -1 : static_cast<int>(bytes);
  }

  const Ring* ring_;
  std::uint32_t last_;
  std::int64_t dropped_ = 0;
};

}  // namespace limber
