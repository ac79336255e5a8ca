// One LCM plane for one process: checked start, allocation-free publishing, waiting with nanosecond
// deadlines.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/black_box/black_box.h"
#include "common/decode_message.h"
#include "common/lcm_url.h"
#include "common/wait_readable.h"

namespace limber {

/// Opens `url`, see checked_lcm_url(). Throws ConfigError: too few descriptors (LCM would end the
/// process), no multicast route. Set-up only.
std::unique_ptr<lcm::LCM> open_lcm(const std::string& url);

class LcmPort {
 public:
  enum class Use { kBothWays, kPublishOnly };
  /// See open_lcm(). LCM's receiving thread starts here, with the priority of the caller; a
  /// port for publishing alone has none, and must not subscribe.
  explicit LcmPort(const std::string& url, Use use = Use::kBothWays);

  /// Encodes into a buffer of its own and sends. False if the message is too long or LCM could not
  /// send it.
  template <typename Message>
  bool publish(const char* channel, const Message& message) noexcept {
    const int size = message.encode(buffer_.data(), 0, kMaxMessageBytes);
    if (size < 0) return false;
    keep(channel, std::span(buffer_).first(static_cast<std::size_t>(size)));
    return publish_bytes(channel, size);
  }

  /// Calls `handler(message)` for each message on the channel that decodes whole and is not too
  /// long; others are dropped. `queue` messages are kept while the process is busy.
  template <typename Message, typename Handler>
  void subscribe(const char* channel, int queue, Handler handler);

  /// Handles what has arrived, at most so many messages, without waiting. LCM's own receive path
  /// may allocate.
  void handle_waiting(int most = kEverything) noexcept;

  /// Keeps what is published and what is handled from now on; outlives this. Set-up only.
  void set_black_box(BlackBox* box) { black_box_ = box; }

  /// -1 of a port for publishing alone.
  int descriptor() const noexcept { return descriptor_; }
  /// Messages of subscribed channels that were dropped: too long, or of another version of their
  /// type.
  std::int64_t undecodable() const noexcept { return undecodable_; }

 private:
  static constexpr int kEverything = std::numeric_limits<int>::max();
  using BytesHandler = std::function<void(const void* data, unsigned size)>;
  void keep(std::string_view channel, std::span<const std::uint8_t> message) noexcept {
    if (black_box_ != nullptr) black_box_->write(channel, message);
  }
  bool publish_bytes(const char* channel, int size) noexcept;
  void subscribe_bytes(const char* channel, int queue, BytesHandler handler);

  std::vector<std::unique_ptr<BytesHandler>>
      handlers_;  // outlive lcm_, which holds pointers to them
  std::unique_ptr<lcm::LCM> lcm_;
  BlackBox* black_box_ = nullptr;
  int descriptor_ = -1;
  std::int64_t undecodable_ = 0;
  std::array<std::uint8_t, kMaxMessageBytes> buffer_{};
};

template <typename Message, typename Handler>
void LcmPort::subscribe(const char* channel, int queue, Handler handler) {
  subscribe_bytes(
      channel, queue,
      [this, channel, handler, message = Message()](const void* data, unsigned size) mutable {
        if (size <= kMaxMessageBytes) keep(channel, {static_cast<const std::uint8_t*>(data), size});
        if (decode_message(data, size, &message)) {
          handler(message);
        } else {
          ++undecodable_;
        }
      });
}

}  // namespace limber
