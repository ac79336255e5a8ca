#include "drivers/bus_end.h"

#include "drivers/can/bus_load.h"
#include "drivers/can/lockstep_frame.h"

namespace limber {

void BusEnd::send() noexcept {
  if (last_) put(*last_);
  const std::span<const CanFrame> batch(batch_.data(), batched_);
  const int accepted = batched_ == 0 ? 0 : bus_->send(batch);
  for (int i = 0; i < accepted; ++i) count_load(batch_[static_cast<std::size_t>(i)]);
  refused_cycles_ = accepted < static_cast<int>(batched_) ? refused_cycles_ + 1 : 0;
}

std::span<const CanFrame> BusEnd::receive() noexcept {
  const int count = bus_->receive(received_);
  const std::span<const CanFrame> frames(received_.data(), static_cast<std::size_t>(count));
  for (const CanFrame& frame : frames) count_load(frame);
  return frames;
}

void BusEnd::count_load(const CanFrame& frame) noexcept {
  if (frame.error || lockstep::is_tick(frame) || lockstep::is_tock(frame)) return;
  busy_s_ += frame_time_s(frame, config_.bitrate_bps, config_.data_bitrate_bps);
}

void BusEnd::expect_tock(std::int64_t seq) noexcept {
  tick_ = seq;
  tocked_ = false;
}

void BusEnd::send_tick() noexcept { bus_->send(lockstep::tick(tick_)); }

bool BusEnd::take_lockstep(const CanFrame& frame) noexcept {
  if (!lockstep::is_tick(frame) && !lockstep::is_tock(frame)) return false;
  if (lockstep::is_tock(frame) && lockstep::sequence(frame) == tick_) tocked_ = true;
  return true;
}

bool BusEnd::lost() const noexcept {
  return refused_cycles_ >= 3 || statistics().bus_off || statistics().link_down;
}

void BusEnd::close_interval(double seconds) noexcept {
  load_ = busy_s_ / seconds;
  busy_s_ = 0.0;
}

}  // namespace limber
