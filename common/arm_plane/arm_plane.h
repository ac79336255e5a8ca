// The control loop's own connection: JOINT_STATE and JOINT_TORQUE between driver and controller,
// received in the loop's thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "common/arm_plane/datagram_port.h"
#include "common/arm_plane/datagram_writer.h"
#include "common/black_box/black_box.h"
#include "common/decode_message.h"

namespace limber {

/// The two messages have no strings or lists: after construction nothing allocates, locks or
/// blocks.
class ArmPlane {
 public:
  /// udpm://GROUP:PORT, LCM's own wire format; unix:PATH for two processes whose users the kernel
  /// vouches for; shm:NAME, shared memory; see datagram_port.h. Throws ConfigError.
  ArmPlane(const std::string& url, ArmPlaneEnd end);

  /// False if the message could not be sent.
  template <typename Message>
  bool publish(std::string_view channel, const Message& message) noexcept {
    const auto written = writer_.write(channel, message);
    if (!written) return false;
    if (black_box_ != nullptr) black_box_->write(channel, written->message);
    return port_->send(written->datagram);
  }

  /// Calls `handler(message)` for each message on `channel`, a literal; others are dropped. Once.
  template <typename Message, typename Handler>
  void subscribe(std::string_view channel, Handler handler) {
    channel_ = channel;
    handler_ = [handler, message = Message()](std::span<const std::uint8_t> bytes) mutable {
      if (!decode_message(bytes.data(), bytes.size(), &message)) return false;
      handler(message);
      return true;
    };
  }

  /// Handles what has arrived, at most kMost datagrams, without waiting.
  void handle_waiting() noexcept;

  /// Keeps what is sent and what is handled from now on; outlives this. Set-up only.
  void set_black_box(BlackBox* box) { black_box_ = box; }

  /// Until something waits to be handled (true), or the absolute CLOCK_MONOTONIC time has come; ns.
  bool wait(std::int64_t deadline_ns) noexcept { return port_->wait(deadline_ns); }
  /// Datagrams on the subscribed channel that were dropped: too long, of another version of their
  /// type, of a user who may not send here, or overwritten.
  std::int64_t undecodable() const noexcept { return undecodable_ + port_->dropped(); }

 private:
  /// A flood must not keep the loop here.
  static constexpr int kMost = 1000;

  std::unique_ptr<DatagramPort> port_;
  std::string_view channel_;
  std::function<bool(std::span<const std::uint8_t>)> handler_;
  BlackBox* black_box_ = nullptr;
  std::int64_t undecodable_ = 0;
  DatagramWriter writer_;
  DatagramBuffer received_{};
};

}  // namespace limber
