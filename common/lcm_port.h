// One LCM plane for one process, in LCM's wire format: read in the thread that handles the
// messages. What nobody here subscribes to, the kernel drops.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/arm_plane/datagram_writer.h"
#include "common/black_box/black_box.h"
#include "common/decode_message.h"
#include "common/lcm_url.h"
#include "common/multicast_socket.h"
#include "common/wait_readable.h"

namespace limber {

/// Messages that LCM would send in fragments, longer than all of limber's, are not received. After
/// the last subscribe(), messages without strings or lists allocate nothing.
class LcmPort {
 public:
  enum class Use { kBothWays, kPublishOnly };
  /// See parse_lcm_url(). A port for publishing alone must not subscribe. Throws ConfigError.
  explicit LcmPort(const std::string& url, Use use = Use::kBothWays);

  /// Encodes into a buffer of its own and sends. False if the message is too long or could not be
  /// sent.
  template <typename Message>
  bool publish(std::string_view channel, const Message& message) noexcept {
    const auto written = writer_.write(channel, message);
    if (!written) return false;
    keep(channel, written->message);
    return send(written->datagram);
  }

  /// Calls `handler(message)` for each message on `channel`, a literal, that decodes whole and is
  /// not too long; others are dropped. `queue` messages are kept while the process is busy, the
  /// rest is lost. Throws ConfigError.
  template <typename Message, typename Handler>
  void subscribe(std::string_view channel, int queue, Handler handler);

  /// Handles what has arrived, in order, at most so many messages, without waiting.
  void handle_waiting(int most = kEverything) noexcept;

  /// Keeps what is published and what is handled from now on; outlives this. Set-up only.
  void set_black_box(BlackBox* box) { black_box_ = box; }
  /// Calls `heard(channel, message)` likewise. Set-up only.
  using Listener = std::function<void(std::string_view, std::span<const std::uint8_t>)>;
  void set_listener(Listener heard) { listener_ = std::move(heard); }

  /// Readable when something has arrived; -1 of a port for publishing alone.
  int descriptor() const noexcept { return sockets_.receiver.get(); }
  /// Messages of subscribed channels that were dropped: too long, or of another version of their
  /// type.
  std::int64_t undecodable() const noexcept { return undecodable_; }

 private:
  static constexpr int kEverything = std::numeric_limits<int>::max();
  using Bytes = std::span<const std::uint8_t>;

  struct Subscription {
    std::string_view channel;
    int room;  ///< for so many more that wait
    std::function<void(Bytes)> handler;
  };
  struct Waiting {
    Subscription* subscription;
    std::size_t size;
    std::array<std::uint8_t, kMaxMessageBytes> bytes;
  };

  void keep(std::string_view channel, Bytes message) {
    if (black_box_ != nullptr) black_box_->write(channel, message);
    if (listener_) listener_(channel, message);
  }
  bool send(Bytes datagram) noexcept;
  void subscribe_bytes(std::string_view channel, int queue, std::function<void(Bytes)> handler);
  void take_arrived() noexcept;
  void take(Bytes datagram) noexcept;

  std::string url_;
  LcmAddress address_;
  MulticastSockets sockets_;
  std::vector<Subscription> subscriptions_;
  std::vector<Waiting> waiting_;  ///< a ring, as long as all queues together
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  BlackBox* black_box_ = nullptr;
  Listener listener_;
  std::int64_t undecodable_ = 0;
  DatagramWriter writer_;
  DatagramBuffer received_{};
};

template <typename Message, typename Handler>
void LcmPort::subscribe(std::string_view channel, int queue, Handler handler) {
  subscribe_bytes(channel, queue, [this, handler, message = Message()](Bytes bytes) mutable {
    if (decode_message(bytes.data(), bytes.size(), &message)) {
      handler(message);
    } else {
      ++undecodable_;
    }
  });
}

}  // namespace limber
