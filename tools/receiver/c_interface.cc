// PlaneReceiver for Python's ctypes (tools/limber/live/line.py): no exception leaves a function.
#include <algorithm>
#include <cstring>
#include <exception>

#include "tools/receiver/plane_receiver.h"

using limber::PlaneReceiver;

#pragma GCC visibility push(default)
extern "C" {

/// `address`: IPv4, in network order. Null: why not is in `problem`, as far as it fits.
void* limber_receiver_open(std::uint32_t address, std::uint16_t port, char* problem,
                           std::size_t room) {
  try {
    sockaddr_in group{};
    group.sin_family = AF_INET;
    group.sin_port = htons(port);
    group.sin_addr.s_addr = address;
    return new PlaneReceiver(group);
  } catch (const std::exception& error) {
    const std::size_t size = std::min(room - 1, std::strlen(error.what()));
    std::memcpy(problem, error.what(), size);
    problem[size] = 0;
    return nullptr;
  }
}

void limber_receiver_close(void* receiver) { delete static_cast<PlaneReceiver*>(receiver); }

/// 0: no memory.
int limber_receiver_hear(void* receiver, const char* channel, std::int32_t number) {
  try {
    static_cast<PlaneReceiver*>(receiver)->hear(channel, number);
    return 1;
  } catch (const std::exception&) {
    return 0;
  }
}

int limber_receiver_wait(void* receiver, std::int64_t timeout_ns) {
  return static_cast<PlaneReceiver*>(receiver)->wait(timeout_ns) ? 1 : 0;
}

std::size_t limber_receiver_take(void* receiver, const std::uint8_t** bytes) {
  const auto taken = static_cast<PlaneReceiver*>(receiver)->take();
  *bytes = taken.data();
  return taken.size();
}

std::int64_t limber_receiver_malformed(void* receiver) {
  return static_cast<PlaneReceiver*>(receiver)->malformed();
}

std::int64_t limber_receiver_dropped(void* receiver) {
  return static_cast<PlaneReceiver*>(receiver)->dropped();
}

}  // extern "C"
#pragma GCC visibility pop
