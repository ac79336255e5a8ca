#include "drivers/can/memory_bus.h"

#include <algorithm>

#include "drivers/can/error_frame.h"

namespace limber {

/// A ring of received frames. One slot stays empty, so that equal indices mean "nothing waits".
class MemoryBus::End final : public CanBus {
 public:
  using CanBus::send;

  explicit End(MemoryBus* bus)
      : bus_(bus), ring_(static_cast<std::size_t>(bus->queue_frames_) + 1) {
    bus_->ends_.push_back(this);
  }
  ~End() override { std::erase(bus_->ends_, this); }

  int send(std::span<const CanFrame> frames) noexcept override {
    int accepted = 0;
    for (const CanFrame& frame : frames) {
      if (!is_possible(frame)) {
        ++statistics_.send_refused;
        continue;
      }
      for (End* end : bus_->ends_) {
        if (end != this) end->push(frame);
      }
      ++accepted;
    }
    statistics_.sent += accepted;
    return accepted;
  }

  int receive(std::span<CanFrame> frames) noexcept override {
    int taken = 0;
    for (CanFrame& frame : frames) {
      if (first_ == last_) break;
      frame = ring_[first_];
      if (frame.error) count_error_frame(frame, &statistics_);
      first_ = next(first_);
      ++taken;
    }
    if (first_ == last_) first_ = last_ = 0;  // the next frame goes where memory is near
    statistics_.received += taken;
    return taken;
  }

  int descriptor() const noexcept override { return -1; }
  const CanStatistics& statistics() const noexcept override { return statistics_; }

 private:
  std::size_t next(std::size_t index) const noexcept {
    return index + 1 == ring_.size() ? 0 : index + 1;
  }

  void push(const CanFrame& frame) noexcept {
    if (next(last_) == first_) {
      ++statistics_.overflow;
      return;
    }
    ring_[last_] = frame;
    last_ = next(last_);
  }

  MemoryBus* bus_;
  std::vector<CanFrame> ring_;
  std::size_t first_ = 0;
  std::size_t last_ = 0;
  CanStatistics statistics_;
};

MemoryBus::MemoryBus(int queue_frames) : queue_frames_(std::max(1, queue_frames)) {}
MemoryBus::~MemoryBus() = default;

std::unique_ptr<CanBus> MemoryBus::attach() { return std::make_unique<End>(this); }

}  // namespace limber
