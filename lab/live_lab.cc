#include "lab/live_lab.h"

#include <spdlog/spdlog.h>

#include <cmath>
#include <stdexcept>

#include "common/clock.h"
#include "common/lcm_url.h"
#include "common/pace_text.h"
#include "common/realtime.h"
#include "sim/processes/world_requests.h"

namespace limber {
namespace {

constexpr std::int64_t kShutDownPatience_ns = 1'000'000'000;
constexpr int kRequestsAtOnce = 4;  // a flood must not keep the arm

}  // namespace

LiveLab::LiveLab(Lab* lab, const Robot& robot, EventLog* log, FrameLog* frames, Pace pace)
    : lab_(lab),
      frames_(frames),
      lock_("driver on " + arm_plane_url()),
      black_box_(open_black_box("lab-" + robot.name, robot.rate_hz, pace)),
      user_(user_plane_url()),
      desk_(&lab->controller(), &user_),
      told_(robot, black_box_.get()) {
  require_local(user_plane_url(), /*moves_motors=*/false);
  sim::take_world_requests(&user_, &lab->simulator(),
                           [](const char* what) { spdlog::warn("{}", what); });
  user_.set_black_box(black_box_.get());
  if (log != nullptr) {
    user_.set_listener([this, log](std::string_view channel, std::span<const std::uint8_t> data) {
      write(log, channel, data);
    });
  }
  if (pace == Pace::kPaced) pacer_.emplace(std::llround(1e9 / robot.rate_hz));
}

// A port's listener must not throw.
void LiveLab::write(EventLog* log, std::string_view channel, std::span<const std::uint8_t> data) {
  try {
    log->write(lab_->state().time_ns / 1000, channel, data.data(),
               static_cast<std::int32_t>(data.size()));
  } catch (const std::runtime_error& error) {
    failure_ = error.what();
  }
}

void LiveLab::run(std::int64_t cycles, const volatile std::sig_atomic_t& stop) {
  while (stop == 0 && (cycles == 0 || lab_->cycles() < cycles)) {
    if (pacer_) wait_until_due();
    cycle();
    if (!failure_.empty()) throw std::runtime_error(failure_);
  }
  if (pacer_ && stop != 0) shut_down();
  messages_.of_end(
      *lab_, [this](const char* channel, const auto& message) { user_.publish(channel, message); });
  if (pacer_) report_pace();
}

// As LockstepRunner's.
void LiveLab::shut_down() {
  const std::int64_t end_ns = lab_->time_ns() + kShutDownPatience_ns;
  lab_->driver().request_shut_down();
  while (!lab_->driver().shut_down() && lab_->time_ns() < end_ns) {
    wait_until_due();
    cycle();
  }
}

void LiveLab::cycle() {
  lab_->step();
  messages_.of_cycle(
      *lab_, [this](const char* channel, const auto& message) { user_.publish(channel, message); });
  told_.note(*lab_);
  if (frames_ != nullptr) frames_->write_cycle(lab_->state().time_ns);
  user_.handle_waiting(kRequestsAtOnce);
  lab_->controller().count_undecodable(user_.undecodable());
}

void LiveLab::wait_until_due() {
  sleep_until(pacer_->next_due_ns(monotonic_ns()));
  const std::optional<double> share = pacer_->behind(monotonic_ns());
  if (!share || told_behind_) return;
  told_behind_ = true;
  spdlog::warn("warning: {}; nothing is lost. Close other programs", pace_text(*share));
}

void LiveLab::report_pace() const {
  const double share = pacer_->share(monotonic_ns());
  const std::string text = length_text(1e-9 * static_cast<double>(lab_->time_ns()), share);
  share < Pacer::kBehind ? spdlog::warn("warning: {}", text) : spdlog::info("{}", text);
}

}  // namespace limber
