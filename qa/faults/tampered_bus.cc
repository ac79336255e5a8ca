#include "qa/faults/tampered_bus.h"

#include <algorithm>
#include <cerrno>

namespace limber::faults {

void TamperedBus::release() {
  arrived_.insert(arrived_.end(), held_.begin(), held_.end());
  held_.clear();
}

int TamperedBus::send(std::span<const CanFrame> frames) noexcept {
  int sent = 0;
  for (const CanFrame& frame : frames) {
    if (refuses_ || cut_off()) break;
    if (!pass_on(frame)) break;
    ++sent;
  }
  refused_ += static_cast<std::int64_t>(frames.size()) - sent;
  if (refuses_) statistics_.last_errno = ENOBUFS;
  update_statistics();
  return sent;
}

/// False if the bus does not take it.
bool TamperedBus::pass_on(const CanFrame& frame) noexcept {
  if (sent_change_) {
    const std::optional<CanFrame> changed = sent_change_(frame);
    return !changed || bus_->send(*changed) == 1;
  }
  const bool replaced = replacement_ && replaced_(frame);
  if (bus_->send(replaced ? *replacement_ : frame) != 1) return false;
  if (replaced) replacement_.reset();
  return true;
}

int TamperedBus::receive(std::span<CanFrame> frames) noexcept {
  CanFrame frame;
  while (bus_->receive(std::span(&frame, 1)) == 1) {
    if (cut_off()) continue;
    if (change_) {
      change_(frame, &arrived_);
    } else {
      arrived_.push_back(frame);
    }
  }
  const std::size_t count = std::min(frames.size(), arrived_.size());
  const auto end = arrived_.begin() + static_cast<std::ptrdiff_t>(count);
  std::copy(arrived_.begin(), end, frames.begin());
  arrived_.erase(arrived_.begin(), end);
  update_statistics();
  return static_cast<int>(count);
}

void TamperedBus::update_statistics() noexcept {
  const CanStatistics& below = bus_->statistics();
  statistics_.sent = below.sent;
  statistics_.received = below.received;
  statistics_.send_refused = below.send_refused + refused_;
  statistics_.error_frames = below.error_frames;
}

}  // namespace limber::faults
