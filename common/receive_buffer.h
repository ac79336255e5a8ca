// How much a socket keeps for a program that the machine lets wait.
#pragma once

#include <sys/socket.h>

namespace limber {

/// What sockets get unless their URL asks for another.
inline constexpr int kReceiveBuffer_bytes = 4 << 20;
/// What programs get that take every message. Memory is used only by what waits.
inline constexpr int kCaptureBuffer_bytes = 64 << 20;

/// A receive buffer of so many bytes; without the privilege for it (CAP_NET_ADMIN) as much as the
/// system permits (net.core.rmem_max). Before the socket is bound: with what the kernel gives a new
/// socket, 93 JOINT_STATEs that come at once are one too many. Set-up only.
inline void set_receive_buffer(int descriptor, int bytes) noexcept {
  if (setsockopt(descriptor, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes) != 0)
    setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
}

/// What it became, bytes. Set-up only.
inline int receive_buffer(int descriptor) noexcept {
  int doubled = 0;  // the kernel counts its own overhead in
  socklen_t size = sizeof doubled;
  getsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &doubled, &size);
  return doubled / 2;
}

}  // namespace limber
