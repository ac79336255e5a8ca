#include "drivers/drive/bus_end.h"

#include <algorithm>

#include "drivers/can/frame_time.h"
#include "drivers/can/lockstep_frame.h"

namespace limber {
namespace {

constexpr std::int64_t kOtherClock_ns = 1'000'000'000;
constexpr int kStuckCycles = 3;

}  // namespace

void BusEnd::send() noexcept {
  const std::size_t commands = batched_;
  if (first_ > 0 && first_ < commands)
    std::rotate(batch_.begin(), batch_.begin() + static_cast<std::ptrdiff_t>(first_),
                batch_.begin() + static_cast<std::ptrdiff_t>(commands));
  if (last_) put(*last_);
  if (question_) put(*question_);
  const std::span<const CanFrame> batch(batch_.data(), batched_);
  const int accepted = batched_ == 0 ? 0 : bus_->send(batch);
  for (int i = 0; i < accepted; ++i) count_load(batch_[static_cast<std::size_t>(i)]);
  const auto taken = static_cast<std::size_t>(std::max(accepted, 0));
  first_ = taken < commands ? (first_ + taken) % commands : 0;
  refused_cycles_ = taken < batched_ ? refused_cycles_ + 1 : 0;
  unsent_cycles_ = bus_->statistics().unsent ? unsent_cycles_ + 1 : 0;
}

std::span<const CanFrame> BusEnd::receive(std::int64_t until_ns) noexcept {
  std::size_t kept = take_held(until_ns);
  more_ = true;
  while (kept == 0 && more_) {
    const auto count = static_cast<std::size_t>(bus_->receive(received_));
    more_ = count == received_.size();
    for (std::size_t i = 0; i < count; ++i) {
      const std::int64_t early_ns = received_[i].timestamp_ns - until_ns;
      if (early_ns > 0 && early_ns < kOtherClock_ns && num_held_ < held_.size()) {
        held_[num_held_++] = received_[i];
      } else {
        received_[kept++] = received_[i];
      }
    }
  }
  const std::span<const CanFrame> frames(received_.data(), kept);
  for (const CanFrame& frame : frames) count_load(frame);
  return frames;
}

std::size_t BusEnd::take_held(std::int64_t until_ns) noexcept {
  std::size_t due = 0;
  while (due < num_held_ && due < received_.size() && held_[due].timestamp_ns <= until_ns) {
    received_[due] = held_[due];
    ++due;
  }
  std::copy(held_.begin() + static_cast<std::ptrdiff_t>(due),
            held_.begin() + static_cast<std::ptrdiff_t>(num_held_), held_.begin());
  num_held_ -= due;
  return due;
}

void BusEnd::count_load(const CanFrame& frame) noexcept {
  if (frame.error || lockstep::is_tick(frame) || lockstep::is_tock(frame)) return;
  busy_s_ += frame_time_s(frame, config_.bitrate_bps, config_.data_bitrate_bps);
}

void BusEnd::expect_tock(std::int64_t seq) noexcept {
  tick_ = seq;
  tocked_ = false;
}

// On a busy machine more than one goes out in a cycle: they are no frames of the arm's.
void BusEnd::send_tick() noexcept { sent_before_ += bus_->send(lockstep::tick(tick_)); }

bool BusEnd::take_lockstep(const CanFrame& frame) noexcept {
  if (!lockstep::is_tick(frame) && !lockstep::is_tock(frame)) return false;
  ++received_before_;
  if (lockstep::is_tock(frame) && lockstep::sequence(frame) == tick_) tocked_ = true;
  return true;
}

std::int8_t BusEnd::state() const noexcept {
  const CanStatistics& statistics = bus_->statistics();
  if (statistics.link_down) return driver_status_t::BUS_LINK_DOWN;
  if (statistics.bus_off) return driver_status_t::BUS_OFF;
  const bool stuck = std::max(refused_cycles_, unsent_cycles_) >= kStuckCycles;
  return stuck ? driver_status_t::BUS_QUEUE_FULL : driver_status_t::BUS_GOOD;
}

void BusEnd::close_interval(double seconds) noexcept {
  load_counted_ = busy_s_ / seconds;
  busy_s_ = 0.0;
}

void BusEnd::write_status(std::size_t b, driver_status_t* status) const noexcept {
  const CanStatistics& statistics = bus_->statistics();
  status->bus_load_predicted[b] = static_cast<float>(load_predicted_);
  status->bus_load_counted[b] = static_cast<float>(load_counted_);
  status->frames_sent[b] = statistics.sent - sent_before_;
  status->frames_received[b] = statistics.received - received_before_;
  status->frames_foreign[b] = foreign_;
  status->send_refused[b] = statistics.send_refused;
  status->error_frames[b] = statistics.error_frames;
  status->bus_state[b] = state();
}

}  // namespace limber
