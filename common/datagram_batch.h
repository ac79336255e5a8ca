// Several datagrams or CAN frames per system call, without allocation: the arrays behind sendmmsg
// and recvmmsg.
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace limber {

/// Most datagrams per system call.
inline constexpr int kBatch = 32;

/// What waits on a socket, with the kernel's receive time and its count of losses. Needs
/// prepare_receive() once.
class ReceiveBatch {
 public:
  /// `with_senders`: sender() is wanted, of sockets of the internet.
  explicit ReceiveBatch(std::size_t longest_bytes, bool with_senders = false);
  ReceiveBatch(const ReceiveBatch&) = delete;
  ReceiveBatch& operator=(const ReceiveBatch&) = delete;

  /// Takes at most min(at_most, kBatch) datagrams without waiting. Returns their number; -1 with
  /// errno set on an error other than "nothing waits". May be called inside the cycle.
  int receive(int descriptor, int at_most) noexcept;

  /// The i-th datagram of the last receive(); empty if it was longer than `longest_bytes`.
  std::span<const std::uint8_t> datagram(int i) const noexcept;
  /// When it arrived, CLOCK_MONOTONIC; never later than now.
  std::int64_t timestamp_ns(int i) const noexcept {
    return timestamps_[static_cast<std::size_t>(i)];
  }
  const sockaddr_in& sender(int i) const noexcept { return senders_[static_cast<std::size_t>(i)]; }
  /// Datagrams the kernel has dropped because the socket's buffer was full, as far as it has
  /// reported.
  std::int64_t lost() const noexcept { return lost_; }

 private:
  void read_control(const msghdr& header, std::size_t i) noexcept;

  struct alignas(cmsghdr) Control {
    std::array<std::byte, 64> bytes;
  };
  std::size_t longest_bytes_;
  std::vector<std::uint8_t> buffer_;
  std::array<Control, kBatch> control_{};
  std::array<iovec, kBatch> vectors_{};
  std::array<mmsghdr, kBatch> messages_{};
  std::array<std::int64_t, kBatch> timestamps_{};
  std::array<sockaddr_in, kBatch> senders_{};
  std::uint32_t lost_count_ = 0;  // the kernel's counter, modulo 2^32
  std::int64_t lost_ = 0;
};

/// Up to kBatch datagrams to be sent in order.
class SendBatch {
 public:
  explicit SendBatch(std::size_t longest_bytes);
  /// Where to; without it, to where the socket is bound or connected. Set-up only.
  void set_destination(const sockaddr_in& destination);
  SendBatch(const SendBatch&) = delete;
  SendBatch& operator=(const SendBatch&) = delete;

  /// Room for the next datagram; write into it, then add() its size. Not to be called when full().
  std::span<std::uint8_t> next() noexcept;
  void add(std::size_t bytes) noexcept;
  bool full() const noexcept { return count_ == kBatch; }

  /// Sends all that were added, without waiting, and forgets them. Returns how many the kernel
  /// took; if not all, errno is the reason. May be called inside the cycle.
  int flush(int descriptor) noexcept;
  int size() const noexcept { return count_; }

 private:
  std::size_t longest_bytes_;
  std::vector<std::uint8_t> buffer_;
  std::array<iovec, kBatch> vectors_{};
  std::array<mmsghdr, kBatch> messages_{};
  sockaddr_in destination_{};
  int count_ = 0;
};

/// Kernel receive stamps and loss counter. Set-up only.
void prepare_receive(int descriptor);

}  // namespace limber
