#include "sim/processes/realtime_runner.h"

#include <spdlog/spdlog.h>

#include "common/clock.h"
#include "common/pace_text.h"

namespace limber::sim {
namespace {

/// What is made up for after a hiccup; beyond it the arm would race.
constexpr std::int64_t kMostCatchUp_ns = 50'000'000;

}  // namespace

RealtimeRunner::RealtimeRunner(SimPort* port) : port_(*port), simulator_(port->simulator()) {
  port_.subscribe_joint_state([this](const joint_state_t& state) { on_state(state); });
}

void RealtimeRunner::run(std::int64_t end_ns, const volatile std::sig_atomic_t& stop) {
  start_ns_ = monotonic_ns();
  while (stop == 0 && simulator_.sim_time_ns() < end_ns) {
    port_.wait(start_ns_ + simulator_.next_step_ns());
    simulator_.poll();
    port_.handle_messages();
    catch_up(monotonic_ns());
  }
}

void RealtimeRunner::catch_up(std::int64_t now_ns) {
  const std::int64_t late_ns = now_ns - start_ns_ - simulator_.next_step_ns();
  if (late_ns >= 0) lateness_.add(late_ns);
  const std::int64_t behind_ns = now_ns - start_ns_ - simulator_.sim_time_ns();
  if (behind_ns > kMostCatchUp_ns) drop_time(behind_ns);
  while (simulator_.next_step_ns() <= now_ns - start_ns_) {
    const std::int64_t periods = simulator_.periods();
    simulator_.advance_to(simulator_.next_step_ns());
    if (simulator_.periods() != periods) port_.publish_truth();
    simulator_.poll();
  }
}

void RealtimeRunner::drop_time(std::int64_t behind_ns) {
  start_ns_ += behind_ns;
  dropped_ns_ += behind_ns;
  ++drops_;
  anchored_ = false;  // simulated time now lags arm time by more
  port_.complain("warning: " + stall_text("limber-sim", behind_ns));
}

void RealtimeRunner::on_state(const joint_state_t& state) {
  if (state.session != session_) {
    session_ = state.session;
    anchored_ = false;
    simulator_.restart_timeline();
  }
  // The way from the driver to here only ever adds to the difference: the smallest seen is the
  // nearest to the truth.
  const std::int64_t offset_ns = monotonic_ns() - start_ns_ - state.time_ns;
  if (anchored_ && offset_ns >= arm_offset_ns_) return;
  anchored_ = true;
  arm_offset_ns_ = offset_ns;
  simulator_.set_arm_time_ns(simulator_.sim_time_ns() - arm_offset_ns_);
}

void RealtimeRunner::report() const {
  if (lateness_.count() > 0) {
    spdlog::info("steps were late by {} us (median), {} us (99.9 %), {} us (max)",
                 lateness_.quantile(0.5) / 1000, lateness_.quantile(0.999) / 1000,
                 lateness_.max() / 1000);
  }
  if (drops_ > 0) {
    spdlog::warn("could not keep up {} times, {:.3f} s dropped in all", drops_,
                 static_cast<double>(dropped_ns_) * 1e-9);
  }
}

}  // namespace limber::sim
