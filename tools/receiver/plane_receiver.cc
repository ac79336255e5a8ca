#include "tools/receiver/plane_receiver.h"

#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <exception>

#include "common/arm_plane/lcm_datagram.h"
#include "common/multicast_socket.h"
#include "common/receive_buffer.h"

namespace limber {
namespace {

constexpr std::size_t kLongestDatagram = 65'536;
/// In one call: what has been kept must be seen now and then.
constexpr int kMostTaken = 256;

std::uint64_t number_of(const sockaddr_in& sender) {
  return std::uint64_t{sender.sin_addr.s_addr} << 16U | sender.sin_port;
}

void append(std::vector<std::uint8_t>* bytes, std::uint32_t value) {
  std::array<std::uint8_t, sizeof value> raw{};
  std::memcpy(raw.data(), &value, sizeof value);
  bytes->insert(bytes->end(), raw.begin(), raw.end());
}

}  // namespace

PlaneReceiver::PlaneReceiver(const sockaddr_in& group)
    : socket_(open_multicast_receiver("user plane", group, kCaptureBuffer_bytes)),
      stop_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      room_(kLongestDatagram) {
  // The program's own thread handles its signals.
  sigset_t all{};
  sigset_t before{};
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread([this] { run(); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

PlaneReceiver::~PlaneReceiver() {
  eventfd_write(stop_.get(), 1);
  thread_.join();
}

void PlaneReceiver::hear(const std::string& channel, std::int32_t number) {
  const std::lock_guard lock(mutex_);
  if (number < 0) {
    channels_.erase(channel);
  } else {
    channels_[channel] = number;
  }
}

bool PlaneReceiver::wait(std::int64_t timeout_ns) {
  std::unique_lock lock(mutex_);
  return news_.wait_for(lock, std::chrono::nanoseconds(timeout_ns),
                        [this] { return !waiting_.empty(); });
}

std::span<const std::uint8_t> PlaneReceiver::take() {
  const std::lock_guard lock(mutex_);
  taken_.clear();
  std::swap(taken_, waiting_);
  return taken_;
}

std::int64_t PlaneReceiver::malformed() const {
  const std::lock_guard lock(mutex_);
  return malformed_;
}

std::int64_t PlaneReceiver::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

void PlaneReceiver::run() noexcept {
  for (;;) {
    std::array<pollfd, 2> entries{{{socket_.get(), POLLIN, 0}, {stop_.get(), POLLIN, 0}}};
    if (poll(entries.data(), entries.size(), -1) < 0) continue;
    if (entries[1].revents != 0) return;
    take_arrived();
  }
}

void PlaneReceiver::take_arrived() noexcept {
  const std::lock_guard lock(mutex_);
  for (int taken = 0; taken < kMostTaken; ++taken) {
    sockaddr_in sender{};
    socklen_t size = sizeof sender;
    const auto bytes = recvfrom(socket_.get(), room_.data(), room_.size(), MSG_DONTWAIT,
                                reinterpret_cast<sockaddr*>(&sender), &size);
    if (bytes < 0) break;
    try {
      handle(std::span(room_).first(static_cast<std::size_t>(bytes)), sender);
    } catch (const std::exception&) {  // no memory for it
      ++dropped_;
    }
  }
  if (!waiting_.empty()) news_.notify_all();
}

void PlaneReceiver::handle(std::span<const std::uint8_t> datagram, const sockaddr_in& sender) {
  if (const auto message = read_lcm_datagram(datagram)) {
    keep(*message);
  } else if (const auto fragment = read_lcm_fragment(datagram)) {
    if (const auto whole = fragments_.add(number_of(sender), *fragment)) keep(*whole);
  } else {
    ++malformed_;
  }
}

void PlaneReceiver::keep(const LcmDatagram& message) {
  const auto found = channels_.find(message.channel);
  if (found == channels_.end()) return;
  if (waiting_.size() + message.message.size() > kMostWaiting) {
    ++dropped_;
    return;
  }
  const std::size_t before = waiting_.size();
  try {
    append(&waiting_, static_cast<std::uint32_t>(found->second));
    append(&waiting_, static_cast<std::uint32_t>(message.message.size()));
    waiting_.insert(waiting_.end(), message.message.begin(), message.message.end());
  } catch (const std::exception&) {
    waiting_.resize(before);
    throw;
  }
}

}  // namespace limber
