#include "drivers/can/serial_bus.h"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>
#include <vector>

#include "common/clock.h"
#include "common/config_error.h"
#include "common/file_descriptor.h"
#include "drivers/can/return_watch.h"
#include "drivers/can/serial_codec.h"
#include "drivers/can/serial_port.h"

namespace limber {
namespace {

class SerialBus final : public CanBus {
 public:
  SerialBus(std::string text, CanAddress line, int bitrate_bps)
      : text_(std::move(text)),
        line_(std::move(line)),
        codec_(line_.carrier == CanCarrier::kSlcan ? make_slcan_codec()
                                                   : make_damiao_serial_codec()),
        greetings_(codec_->greetings(bitrate_bps)) {
    open();
  }

  ~SerialBus() override {
    watch_.stop();
    const std::string bytes = codec_->farewell();
    if (!watch_.gone() && ::write(port_.get(), bytes.data(), bytes.size()) < 0) return;
  }

  int send(std::span<const CanFrame> frames) noexcept override {
    int accepted = 0;
    if (ready()) {
      statistics_.unsent = waiting_bytes() > 0 || rest_ > 0;
      for (const CanFrame& frame : frames) {
        if (!finish_last() || watch_.gone()) break;
        if (!is_possible(frame) || frame.fd) continue;
        rest_ = size_ = codec_->encode(frame, out_);
        if (write_rest()) ++accepted;
      }
    }
    statistics_.sent += accepted;
    statistics_.send_refused += static_cast<std::int64_t>(frames.size()) - accepted;
    return accepted;
  }

  int receive(std::span<CanFrame> frames) noexcept override {
    std::size_t taken = 0;
    while (taken < frames.size() && (begin_ < end_ || read_more())) {
      switch (codec_->take(in_[begin_++], &frames[taken])) {
        case SerialEvent::kNothing:
        case SerialEvent::kDone:
          break;
        case SerialEvent::kFrame:
          frames[taken++].timestamp_ns = read_ns_;
          break;
        case SerialEvent::kRefused:
          ++statistics_.send_refused;
          break;
        case SerialEvent::kGarbage:
          ++statistics_.malformed;
          break;
      }
    }
    statistics_.received += static_cast<std::int64_t>(taken);
    return static_cast<int>(taken);
  }

  int descriptor() const noexcept override { return watch_.gone() ? -1 : port_.get(); }
  bool something_waits() const noexcept override { return begin_ < end_; }
  const CanStatistics& statistics() const noexcept override { return statistics_; }

 private:
  /// False while the line is gone, and its thread has the descriptor.
  bool ready() noexcept {
    statistics_.link_down = watch_.gone();
    return !statistics_.link_down;
  }

  void note_gone(int error) noexcept {
    statistics_.last_errno = error;
    statistics_.link_down = true;
    begin_ = end_ = rest_ = 0;
    watch_.note_gone();
  }

  int waiting_bytes() const noexcept {
    int bytes = 0;
    return ioctl(port_.get(), TIOCOUTQ, &bytes) == 0 ? bytes : 0;
  }

  /// A frame that was cut short has its end sent before the next one begins.
  bool finish_last() noexcept { return rest_ == 0 || write_rest(); }

  /// True once some of the frame is on its way, which then counts as sent.
  bool write_rest() noexcept {
    const bool begun = rest_ < size_;
    const ssize_t written = ::write(port_.get(), &out_[size_ - rest_], rest_);
    if (written < 0 && errno != EAGAIN && errno != EINTR) {
      note_gone(errno);
      return false;
    }
    if (written > 0) rest_ -= static_cast<std::size_t>(written);
    if (begun) return rest_ == 0;
    if (written > 0) return true;
    rest_ = 0;  // nothing of it was taken: dropped, never queued
    return false;
  }

  bool read_more() noexcept {
    if (!ready()) return false;
    const ssize_t bytes = ::read(port_.get(), in_.data(), in_.size());
    if (bytes == 0 || (bytes < 0 && errno != EAGAIN && errno != EINTR))
      note_gone(bytes == 0 ? ENODEV : errno);
    if (bytes <= 0) return false;
    read_ns_ = monotonic_ns();
    begin_ = 0;
    end_ = static_cast<std::size_t>(bytes);
    return true;
  }

  void open() {
    port_ = open_serial_port(text_, line_.place, line_.baud);
    codec_->reset();
    for (const SerialGreeting& greeting : greetings_) greet(greeting);
  }

  void greet(const SerialGreeting& greeting) {
    const auto size = static_cast<ssize_t>(greeting.bytes.size());
    if (::write(port_.get(), greeting.bytes.data(), greeting.bytes.size()) != size)
      throw ConfigError(text_ + ": takes no bytes");
    // Some adapters answer nothing: that counts as done.
    CanFrame frame;
    pollfd waiting{port_.get(), POLLIN, 0};
    while (poll(&waiting, 1, greeting.any_answer ? kSilence_ms : kAnswer_ms) > 0) {
      std::uint8_t byte = 0;
      if (::read(port_.get(), &byte, 1) != 1) return;
      const SerialEvent event = codec_->take(byte, &frame);
      if (greeting.any_answer) continue;
      if (event == SerialEvent::kDone) return;
      if (event == SerialEvent::kRefused)
        throw ConfigError(text_ + ": the adapter refuses " + greeting.meaning);
    }
  }

  bool open_again() {
    port_ = FileDescriptor();  // the device is free for its return
    try {
      open();
      return true;
    } catch (const ConfigError&) {
      return false;  // not there yet
    }
  }

  static constexpr int kAnswer_ms = 500;
  static constexpr int kSilence_ms = 100;

  std::string text_;
  CanAddress line_;
  std::unique_ptr<SerialCodec> codec_;
  std::vector<SerialGreeting> greetings_;
  FileDescriptor port_;
  CanStatistics statistics_;
  std::array<std::uint8_t, SerialCodec::kLongest> out_{};  ///< the frame that is being written
  std::size_t size_ = 0;
  std::size_t rest_ = 0;  ///< of it, bytes at its end
  std::array<std::uint8_t, 4096> in_{};
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::int64_t read_ns_ = 0;
  ReturnWatch watch_{[this] { return open_again(); }};  ///< port_ and codec_ are its own while gone
};

}  // namespace

std::unique_ptr<CanBus> open_serial_bus(const std::string& text, const CanAddress& line, bool fd,
                                        int bitrate_bps) {
  if (fd) throw ConfigError(text + ": carries no CAN-FD, which the robot needs");
  return std::make_unique<SerialBus>(text, line, bitrate_bps);
}

}  // namespace limber
