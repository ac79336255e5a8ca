#include "sim/sim_process.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "common/clock.h"
#include "common/realtime.h"
#include "lcmtypes/channels.h"

namespace limber {
namespace {

/// What is made up for after a hiccup; beyond it the arm would race.
constexpr std::int64_t kMostCatchUp_ns = 50'000'000;
/// How long a stop request may go unnoticed.
constexpr std::int64_t kPatience_ns = 100'000'000;
constexpr std::int64_t kComplaintInterval_ns = 1'000'000'000;
/// Every state matters for the arm's time; a push or an event now and then.
constexpr int kStateQueue = 100;
constexpr int kUserQueue = 100;

std::vector<CanBus*> pointers(const std::vector<std::unique_ptr<CanBus>>& buses) {
  std::vector<CanBus*> out;
  for (const auto& bus : buses) out.push_back(bus.get());
  return out;
}

std::string schedule(const SimProcessOptions& options) {
  if (options.simulator.lockstep) return "lock step";
  const int priority = options.priority;
  if (priority == 0) return "realtime, normal scheduling";
  const RealtimeGrant grant = ask_for_realtime(priority);
  std::string out =
      grant.fifo ? fmt::format("realtime, SCHED_FIFO {}", priority) : "realtime, normal scheduling";
  out += grant.locked_memory ? ", locked memory" : "";
  return grant.reason.empty() ? out : fmt::format("{} ({})", out, grant.reason);
}

}  // namespace

std::vector<std::unique_ptr<CanBus>> open_buses(const Robot& robot) {
  std::vector<std::unique_ptr<CanBus>> buses;
  for (const BusConfig& bus : robot.buses) buses.push_back(open_can_bus(bus.can, bus.fd));
  return buses;
}

SimProcess::SimProcess(const LoadedRobot& robot, const std::vector<TimedMessage>* timeline,
                       const SimProcessOptions& options)
    : name_(robot.robot.name),
      options_(options),
      scheduling_(schedule(options)),
      buses_(open_buses(robot.robot)),
      simulator_(robot, pointers(buses_), options.simulator),
      user_(user_plane_url()),
      end_ns_(std::llround(options.duration_s * 1e9)) {
  simulator_.set_timeline(timeline);
  for (const auto& bus : buses_) descriptors_.push_back(bus->descriptor());
  descriptors_.push_back(user_.descriptor());
  subscribe();
}

void SimProcess::subscribe() {
  user_.subscribe<push_t>(channels::kPush, kUserQueue, [this](const push_t& push) {
    if (!simulator_.push(push)) complain("a PUSH was refused (values, link, or no free slot)");
  });
  user_.subscribe<scenario_event_t>(
      channels::kScenarioEvent, kUserQueue, [this](const scenario_event_t& event) {
        if (!simulator_.event(event))
          complain("a SCENARIO_EVENT was refused (values out of range)");
      });
  if (options_.simulator.lockstep) return;
  user_.subscribe<joint_state_t>(channels::kJointState, kStateQueue,
                                 [this](const joint_state_t& state) { learn_arm_time(state); });
}

void SimProcess::run(const std::atomic<bool>& stop) {
  fmt::print(stderr, "limber-sim: {}, {} at {:g} us, {}\n", name_,
             options_.simulator.integrator == Integrator::kOde ? "ode" : "reference",
             1e6 * options_.simulator.step_s, scheduling_);
  if (options_.simulator.lockstep) {
    run_lockstep(stop);
  } else {
    run_realtime(stop);
  }
  report();
}

void SimProcess::run_lockstep(const std::atomic<bool>& stop) {
  while (!stop.load() && !over()) {
    wait_readable(descriptors_, monotonic_ns() + kPatience_ns);
    user_.handle_waiting();
    while (!over() && simulator_.poll()) publish_truth();
  }
}

void SimProcess::run_realtime(const std::atomic<bool>& stop) {
  start_ns_ = monotonic_ns();
  while (!stop.load() && !over()) {
    wait_readable(descriptors_, start_ns_ + simulator_.next_step_ns());
    simulator_.poll();
    user_.handle_waiting();
    catch_up(monotonic_ns());
  }
}

void SimProcess::catch_up(std::int64_t now_ns) {
  const std::int64_t behind_ns = now_ns - start_ns_ - simulator_.sim_time_ns();
  if (simulator_.next_step_ns() <= now_ns - start_ns_) {
    lateness_.add(now_ns - start_ns_ - simulator_.next_step_ns());
  }
  if (behind_ns > kMostCatchUp_ns) {
    start_ns_ += behind_ns;
    dropped_ns_ += behind_ns;
    ++drops_;
    anchored_ = false;  // simulated time now lags arm time by more
    complain("cannot keep up: simulated time was dropped");
  }
  while (simulator_.next_step_ns() <= now_ns - start_ns_) {
    const std::int64_t periods = simulator_.periods();
    simulator_.advance_to(simulator_.next_step_ns());
    if (simulator_.periods() != periods) publish_truth();
    simulator_.poll();
  }
}

void SimProcess::learn_arm_time(const joint_state_t& state) {
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

void SimProcess::publish_truth() { user_.publish(channels::kSimTruth, simulator_.truth()); }

void SimProcess::complain(const char* what) {
  const std::int64_t now_ns = monotonic_ns();
  if (complained_ns_ != 0 && now_ns - complained_ns_ < kComplaintInterval_ns) return;
  complained_ns_ = now_ns;
  fmt::print(stderr, "limber-sim: {}\n", what);
}

void SimProcess::report() const {
  fmt::print(stderr, "limber-sim: ended at {:.3f} s of simulated time\n",
             static_cast<double>(simulator_.sim_time_ns()) * 1e-9);
  if (lateness_.count() > 0) {
    fmt::print(
        stderr, "limber-sim: steps were late by {} us (median), {} us (99.9 %), {} us (max)\n",
        lateness_.quantile(0.5) / 1000, lateness_.quantile(0.999) / 1000, lateness_.max() / 1000);
  }
  if (drops_ > 0) {
    fmt::print(stderr, "limber-sim: could not keep up {} times, {:.3f} s dropped in all\n", drops_,
               static_cast<double>(dropped_ns_) * 1e-9);
  }
  if (simulator_.refused() > 0) {
    fmt::print(stderr, "limber-sim: {} messages of the timeline were refused\n",
               simulator_.refused());
  }
  if (simulator_.diverged() > 0) {
    fmt::print(stderr, "limber-sim: {} steps would have diverged; the arm was stopped instead\n",
               simulator_.diverged());
  }
}

}  // namespace limber
