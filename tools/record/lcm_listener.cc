#include "tools/record/lcm_listener.h"

#include <linux/sock_diag.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "common/lcm_url.h"
#include "common/multicast_socket.h"
#include "common/open_files.h"
#include "common/receive_buffer.h"

namespace limber {
namespace {

/// Below this a pause of a fraction of a second costs messages at 1 kHz. `limber doctor` wants as
/// much.
constexpr int kSmall_bytes = 2 << 20;
constexpr std::size_t kLongestDatagram = 65'507;

FileDescriptor open_socket(const std::string& url) {
  require_open_files();
  const LcmAddress address = parse_lcm_url(url);
  const int wanted = address.receive_buffer_bytes.value_or(kCaptureBuffer_bytes);
  FileDescriptor socket = open_multicast_receiver("user plane " + url, address.group, wanted);
  prepare_receive(socket.get());
  const int bytes = receive_buffer(socket.get());
  if (bytes < std::min(wanted, kSmall_bytes)) {
    spdlog::info(
        "note: the system permits a receive buffer of only {} kB, so messages are lost while this "
        "machine is busy. Permit more: sudo sysctl -w net.core.rmem_max={}",
        bytes / 1000, wanted);
  }
  return socket;
}

std::uint64_t number_of(const sockaddr_in& sender) {
  return std::uint64_t{sender.sin_addr.s_addr} << 16U | sender.sin_port;
}

}  // namespace

LcmListener::LcmListener(const std::string& url)
    : socket_(open_socket(url)), batch_(kLongestDatagram, true) {}

int LcmListener::take_batch(const Handler& handler) {
  const int count = batch_.receive(socket_.get(), kBatch);
  if (count < 0)
    throw std::runtime_error(std::string("the socket cannot be read: ") + std::strerror(errno));
  for (int i = 0; i < count; ++i) take(i, handler);
  return count;
}

void LcmListener::take(int i, const Handler& handler) {
  // The kernel's stamps, brought to another clock, may go back by microseconds.
  newest_ns_ = std::max(newest_ns_, batch_.timestamp_ns(i));
  const std::int64_t time_us = (epoch_minus_monotonic_ns_ + newest_ns_) / 1000;
  const std::span<const std::uint8_t> datagram = batch_.datagram(i);
  if (const auto message = read_lcm_datagram(datagram)) {
    handler(time_us, *message);
  } else if (const auto fragment = read_lcm_fragment(datagram)) {
    if (const auto whole = fragments_.add(number_of(batch_.sender(i)), *fragment))
      handler(time_us, *whole);
  } else if (!std::exchange(told_, true)) {
    spdlog::warn(
        "a datagram that is no message of LCM's, or has an impossible size, was left out; so are "
        "others like it");
  }
}

std::int64_t LcmListener::dropped() const {
  // Also of those behind which nothing has come; batch_ knows of the others alone.
  std::array<std::uint32_t, SK_MEMINFO_VARS> counts{};
  socklen_t size = sizeof(counts);
  const bool told = getsockopt(socket_.get(), SOL_SOCKET, SO_MEMINFO, counts.data(), &size) == 0;
  return std::max<std::int64_t>(batch_.lost(), told ? counts[SK_MEMINFO_DROPS] : 0);
}

}  // namespace limber
