#include "common/datagram_batch.h"

#include <time.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include "common/clock.h"
#include "common/clock_pair.h"
#include "common/file_descriptor.h"

namespace limber {
namespace {

std::int64_t to_ns(const timespec& time) noexcept {
  return time.tv_sec * 1'000'000'000LL + time.tv_nsec;
}

std::int64_t realtime_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return to_ns(now);
}

// The kernel begins to stamp some time after it was told to: on a busy machine after many
// milliseconds, until which a stamp is the time of reading. Datagrams to oneself tell when.
void wait_for_stamps() {
  constexpr int kMost_ms = 1000;
  const FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in self{};
  self.sin_family = AF_INET;
  self.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  auto* const address = reinterpret_cast<sockaddr*>(&self);
  socklen_t size = sizeof(self);
  const int on = 1;
  // Where nothing goes through the loopback there is nothing to wait for.
  if (bind(socket.get(), address, size) != 0 || getsockname(socket.get(), address, &size) != 0 ||
      connect(socket.get(), address, size) != 0 ||
      setsockopt(socket.get(), SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof(on)) != 0)
    return;
  ReceiveBatch batch(1);
  for (int waited_ms = 0; waited_ms < kMost_ms; ++waited_ms) {
    if (send(socket.get(), "", 1, MSG_DONTWAIT) != 1) return;
    const std::int64_t sent_ns = monotonic_ns();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (batch.receive(socket.get(), 1) == 1 && batch.timestamp_ns(0) <= sent_ns) return;
  }
}

}  // namespace

ReceiveBatch::ReceiveBatch(std::size_t longest_bytes, bool with_senders)
    : longest_bytes_(longest_bytes), buffer_(longest_bytes * kBatch) {
  for (std::size_t i = 0; i < kBatch; ++i) {
    vectors_[i] = {buffer_.data() + i * longest_bytes_, longest_bytes_};
    messages_[i].msg_hdr.msg_iov = &vectors_[i];
    messages_[i].msg_hdr.msg_iovlen = 1;
    messages_[i].msg_hdr.msg_control = &control_[i];
    if (with_senders) messages_[i].msg_hdr.msg_name = &senders_[i];
  }
}

int ReceiveBatch::receive(int descriptor, int at_most) noexcept {
  const auto wanted = static_cast<unsigned>(std::clamp(at_most, 0, kBatch));
  for (unsigned i = 0; i < wanted; ++i) {
    messages_[i].msg_hdr.msg_controllen = sizeof(Control);
    messages_[i].msg_hdr.msg_namelen = sizeof(sockaddr_in);  // ignored without a name
  }
  const int count = recvmmsg(descriptor, messages_.data(), wanted, MSG_DONTWAIT, nullptr);
  if (count < 0) return errno == EAGAIN || errno == EWOULDBLOCK ? 0 : -1;
  if (count == 0) return 0;
  // The kernel stamps with the wall clock. An offset taken now carries a stamp over to the
  // monotonic clock unless the wall clock was set in the microseconds between.
  const auto [now_ns, wall_now_ns] = read_together(monotonic_ns, realtime_ns);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    timestamps_[i] = wall_now_ns;
    read_control(messages_[i].msg_hdr, i);
    timestamps_[i] = now_ns + std::min<std::int64_t>(timestamps_[i] - wall_now_ns, 0);
  }
  return count;
}

void ReceiveBatch::read_control(const msghdr& header, std::size_t i) noexcept {
  msghdr copy = header;  // CMSG_NXTHDR wants it writable
  for (cmsghdr* part = CMSG_FIRSTHDR(&copy); part != nullptr; part = CMSG_NXTHDR(&copy, part)) {
    if (part->cmsg_level != SOL_SOCKET) continue;
    if (part->cmsg_type == SCM_TIMESTAMPNS) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(part), sizeof(stamp));
      timestamps_[i] = to_ns(stamp);
    } else if (part->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t lost = 0;
      std::memcpy(&lost, CMSG_DATA(part), sizeof(lost));
      lost_ += static_cast<std::uint32_t>(lost - lost_count_);
      lost_count_ = lost;
    }
  }
}

std::span<const std::uint8_t> ReceiveBatch::datagram(int i) const noexcept {
  const auto index = static_cast<std::size_t>(i);
  if ((messages_[index].msg_hdr.msg_flags & MSG_TRUNC) != 0) return {};
  return {buffer_.data() + index * longest_bytes_, messages_[index].msg_len};
}

SendBatch::SendBatch(std::size_t longest_bytes)
    : longest_bytes_(longest_bytes), buffer_(longest_bytes * kBatch) {
  for (std::size_t i = 0; i < kBatch; ++i) {
    vectors_[i] = {buffer_.data() + i * longest_bytes_, 0};
    messages_[i].msg_hdr.msg_iov = &vectors_[i];
    messages_[i].msg_hdr.msg_iovlen = 1;
  }
}

void SendBatch::set_destination(const sockaddr_in& destination) {
  destination_ = destination;
  for (mmsghdr& message : messages_) {
    message.msg_hdr.msg_name = &destination_;
    message.msg_hdr.msg_namelen = sizeof(destination_);
  }
}

std::span<std::uint8_t> SendBatch::next() noexcept {
  return {buffer_.data() + static_cast<std::size_t>(count_) * longest_bytes_, longest_bytes_};
}

void SendBatch::add(std::size_t bytes) noexcept {
  vectors_[static_cast<std::size_t>(count_++)].iov_len = bytes;
}

int SendBatch::flush(int descriptor) noexcept {
  int sent = 0;
  errno = 0;
  while (sent < count_) {
    const int taken = sendmmsg(descriptor, messages_.data() + sent,
                               static_cast<unsigned>(count_ - sent), MSG_DONTWAIT);
    if (taken < 0) break;
    sent += taken;
  }
  count_ = 0;
  return sent;
}

void prepare_receive(int descriptor) {
  const int on = 1;
  // Where a kernel has no stamps or loss counter, receive time is "now" and losses stay unseen:
  // worth running without.
  setsockopt(descriptor, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof(on));
  wait_for_stamps();
  setsockopt(descriptor, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof(on));
}

}  // namespace limber
