// The anchor of all round trips: a bare UDP unicast ping-pong between two processes, both blocking.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <stdexcept>
#include <vector>

#include "common/clock.h"
#include "common/file_descriptor.h"
#include "common/realtime.h"
#include "qa/bench/child_process.h"

namespace limber::bench {

inline constexpr int kPriority = 40;

/// Before each round trip, as in use: the other process has finished what it does after an answer.
inline void pause_between_rounds() {
  const std::int64_t end_ns = monotonic_ns() + 60'000;
  while (monotonic_ns() < end_ns) {
  }
}

class UdpPing {
 public:
  /// Starts the process that answers each message of `bytes` with one of `answer_bytes`, with
  /// SCHED_FIFO where that is permitted and `realtime` is set.
  UdpPing(std::size_t bytes, std::size_t answer_bytes, bool realtime)
      : message_(bytes), answer_(2048) {
    const FileDescriptor peer = open();
    connect_to(socket_, peer);
    connect_to(peer, socket_);
    child_ = spawn([&] {
      if (realtime) ask_for_realtime(kPriority);
      std::vector<char> buffer(2048);
      while (recv(peer.get(), buffer.data(), buffer.size(), 0) >= 0)
        send(peer.get(), buffer.data(), answer_bytes, 0);
    });
  }
  UdpPing(const UdpPing&) = delete;
  UdpPing& operator=(const UdpPing&) = delete;
  ~UdpPing() {
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
  }

  /// Of one round trip, ns.
  std::int64_t round() {
    pause_between_rounds();
    const std::int64_t start = monotonic_ns();
    send(socket_.get(), message_.data(), message_.size(), 0);
    recv(socket_.get(), answer_.data(), answer_.size(), 0);
    return monotonic_ns() - start;
  }

 private:
  static FileDescriptor open() {
    FileDescriptor opened(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    sockaddr_in any{};
    any.sin_family = AF_INET;
    any.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (bind(opened.get(), reinterpret_cast<sockaddr*>(&any), sizeof any) != 0)
      throw std::runtime_error("no UDP on this machine");
    return opened;
  }
  static void connect_to(const FileDescriptor& from, const FileDescriptor& to) {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    if (getsockname(to.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0 ||
        connect(from.get(), reinterpret_cast<sockaddr*>(&address), size) != 0)
      throw std::runtime_error("no UDP on this machine");
  }

  FileDescriptor socket_ = open();
  std::vector<char> message_;
  std::vector<char> answer_;
  pid_t child_ = -1;
};

}  // namespace limber::bench
