// One LCM plane for one process: checked start, allocation-free publishing, waiting with nanosecond
// deadlines.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/wait_readable.h"

namespace limber {

/// Longest encoded message: never fragmented on any link.
inline constexpr int kMaxMessageBytes = 1400;

class LcmPort {
 public:
  /// Opens `url` with a 2 MiB receive buffer. Refuses a ttl above 0 unless LIMBER_ALLOW_REMOTE=1 is
  /// set. Throws ConfigError with the two commands that help when there is no multicast route.
  explicit LcmPort(const std::string& url);

  /// Encodes into a buffer of its own and sends. False if the message is too long or LCM could not
  /// send it.
  template <typename Message>
  bool publish(const char* channel, const Message& message) noexcept {
    const int size = message.encode(buffer_.data(), 0, kMaxMessageBytes);
    return size >= 0 && publish_bytes(channel, size);
  }

  /// Calls `handler(message)` for each message on the channel that decodes whole and is not too
  /// long; others are dropped. `queue` messages are kept while the process is busy.
  template <typename Message, typename Handler>
  void subscribe(const char* channel, int queue, Handler handler);

  /// Handles everything that has arrived, without waiting. LCM's own receive path may allocate.
  void handle_waiting() noexcept;

  int descriptor() const noexcept { return descriptor_; }

 private:
  using BytesHandler = std::function<void(const void* data, unsigned size)>;
  bool publish_bytes(const char* channel, int size) noexcept;
  void subscribe_bytes(const char* channel, int queue, BytesHandler handler);

  std::vector<std::unique_ptr<BytesHandler>>
      handlers_;  // outlive lcm_, which holds pointers to them
  std::unique_ptr<lcm::LCM> lcm_;
  int descriptor_ = -1;
  std::array<std::uint8_t, kMaxMessageBytes> buffer_{};
};

/// `url` with a 2 MiB receive buffer; refuses a ttl above 0 unless LIMBER_ALLOW_REMOTE=1. Throws
/// ConfigError. Set-up only.
std::string checked_lcm_url(const std::string& url);
/// The error message for a machine without a multicast route.
std::string no_multicast_route(const std::string& url);

/// $LIMBER_ARM_URL or the arm plane's address of the channel table; $LCM_DEFAULT_URL or the user
/// plane's.
std::string arm_plane_url();
std::string user_plane_url();

template <typename Message, typename Handler>
void LcmPort::subscribe(const char* channel, int queue, Handler handler) {
  subscribe_bytes(channel, queue,
                  [this, handler, message = Message()](const void* data, unsigned size) mutable {
                    if (size > static_cast<unsigned>(kMaxMessageBytes) ||
                        message.decode(data, 0, static_cast<int>(size)) != static_cast<int>(size)) {
                      return;
                    }
                    handler(message);
                  });
}

}  // namespace limber
