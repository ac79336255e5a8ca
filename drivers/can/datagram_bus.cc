#include "drivers/can/datagram_bus.h"

#include <algorithm>

#include "drivers/can/error_frame.h"

namespace limber {

int DatagramBus::send(std::span<const CanFrame> frames) noexcept {
  int accepted = 0;
  note_sending();
  for (const CanFrame& frame : frames) {
    if (!is_possible(frame) || (frame.fd && !fd_)) continue;
    outgoing_.add(encode(frame, outgoing_.next()));
    if (outgoing_.full()) accepted += flush();
  }
  accepted += flush();
  statistics_.sent += accepted;
  statistics_.send_refused += static_cast<std::int64_t>(frames.size()) - accepted;
  return accepted;
}

int DatagramBus::flush() noexcept {
  const int wanted = outgoing_.size();
  if (wanted == 0) return 0;
  const int sent = outgoing_.flush(sender_.get() >= 0 ? sender_.get() : receiver_.get());
  note_sent(sent, wanted);
  return sent;
}

int DatagramBus::receive(std::span<CanFrame> frames) noexcept {
  std::size_t taken = 0;
  bool failed = false;
  while (taken < frames.size()) {
    const int wanted = std::min(static_cast<int>(frames.size() - taken), kBatch);
    const int count = incoming_.receive(receiver_.get(), wanted);
    if (count < 0) {
      if (!note_receive_error() || failed) break;
      failed = true;
      continue;
    }
    for (int i = 0; i < count; ++i) taken += accept(i, &frames[taken]) ? 1U : 0U;
    if (count < wanted) break;  // nothing is left: no call of its own to learn that
  }
  statistics_.received += static_cast<std::int64_t>(taken);
  statistics_.overflow = incoming_.lost();
  return static_cast<int>(taken);
}

bool DatagramBus::accept(int i, CanFrame* frame) noexcept {
  if (!decode(incoming_.datagram(i), frame)) {
    ++statistics_.malformed;
    return false;
  }
  if (stamps_ == Stamps::kOnArrival) frame->timestamp_ns = incoming_.timestamp_ns(i);
  if (frame->error) count_error_frame(*frame, &statistics_);
  return note_received(*frame);
}

}  // namespace limber
