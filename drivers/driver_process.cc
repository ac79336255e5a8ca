#include "drivers/driver_process.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/clock.h"
#include "common/config_error.h"
#include "drivers/can/bus_load.h"
#include "drivers/roll_call.h"
#include "lcmtypes/channels.h"
#include "robots/load_robot.h"

namespace limber {
namespace {

constexpr std::int64_t kSpin_ns = 80'000;  // before each deadline; sleeping is 10 to 50 us late
constexpr double kReplyShare = 0.6;        // of the period, at most, for the motors' replies
constexpr std::int64_t kRepeat_ns = 100'000'000;  // lock step: say it again, a datagram may be lost
constexpr double kShutDownPatience_s = 1.0;
// A virtual bus is as punctual as this machine's scheduler, which pauses a process for tens of
// milliseconds now and then; a wire is not. What would be a cut cable there is a hiccup here.
constexpr double kVirtualBridge_s = 0.05;
constexpr double kVirtualWatchdog_s = 0.1;

Robot load(const DriverProcessOptions& options) {
  Robot robot = load_robot(options.robot).robot;
  if (options.rate_hz > 0.0) robot.rate_hz = options.rate_hz;
  std::string names;
  for (const BusConfig& bus : robot.buses) names += (names.empty() ? "" : ", ") + bus.name;
  for (const auto& [name, address] : options.buses) {
    bool known = false;
    for (BusConfig& bus : robot.buses) {
      if (bus.name != name) continue;
      bus.can = address;
      known = true;
    }
    if (!known)
      throw ConfigError(fmt::format("--bus {}={}: {} has no bus '{}'; it has: {}", name, address,
                                    robot.name, name, names));
  }
  return robot;
}

/// The tolerances of a realtime run on virtual buses: the drives' watchdogs wait longer, too.
int bridged_cycles(const DriverProcessOptions& options, Robot* robot) {
  const int on_a_wire = ArmDriverOptions().bridged_cycles;
  if (options.lockstep || !robot->on_virtual_buses()) return on_a_wire;
  for (JointConfig& joint : robot->joints) {
    for (DriveConfig* drive : {&joint.drive, &joint.antagonist})
      drive->watchdog_s = std::max(drive->watchdog_s, kVirtualWatchdog_s);
  }
  return std::max(on_a_wire, static_cast<int>(kVirtualBridge_s * robot->rate_hz));
}

std::int64_t random_session() {
  std::uint64_t number = 0;
  while (number == 0) {
    if (getrandom(&number, sizeof(number), 0) != sizeof(number))
      throw ConfigError("the kernel gives no random numbers for the session");
    number &= 0x7FFF'FFFF'FFFF'FFFFU;
  }
  return static_cast<std::int64_t>(number);
}

std::vector<std::string> joint_names(const Robot& robot) {
  std::vector<std::string> names;
  for (const JointConfig& joint : robot.joints) names.push_back(joint.name);
  return names;
}

std::string said(const RealtimeGrant& grant, int priority) {
  if (priority == 0) return "real-time priority not asked for";
  if (grant.fifo && grant.locked_memory)
    return fmt::format("real-time priority {} and locked memory granted", priority);
  return "NOT real-time: " + grant.reason;
}

}  // namespace

DriverProcess::DriverProcess(const DriverProcessOptions& options)
    : options_(options),
      robot_(load(options)),
      bridged_cycles_(bridged_cycles(options, &robot_)),
      period_ns_(std::llround(1e9 / robot_.rate_hz)),
      session_(options.session != 0 ? options.session
               : options.lockstep   ? 1
                                    : random_session()),
      loop_(period_ns_, kSpin_ns),
      overruns_(std::llround(std::ceil(robot_.rate_hz)), bridged_cycles_) {
  // In this order: LCM starts a thread for each port. The user plane's, which anybody may flood,
  // keeps normal priority; the arm plane's inherits ours.
  reporter_ = std::make_unique<StateReporter>(joint_names(robot_));
  user_plane_ = std::make_unique<LcmPort>(user_plane_url());
  if (!options_.lockstep && options_.realtime_priority > 0)
    grant_ = ask_for_realtime(options_.realtime_priority);
  arm_plane_ = std::make_unique<LcmPort>(arm_plane_url());
  arm_plane_->subscribe<joint_torque_t>(channels::kJointTorque, 30,
                                        [this](const joint_torque_t& c) { on_torque(c); });
  for (const BusConfig& bus : robot_.buses) {
    buses_.push_back(open_can_bus(bus.can, bus.fd));
    bus_pointers_.push_back(buses_.back().get());
  }
  driver_ = std::make_unique<ArmDriver>(
      robot_, bus_pointers_, ArmDriverOptions{session_, options_.lockstep, bridged_cycles_});
}

void DriverProcess::say_start() const {
  std::string buses;
  for (std::size_t b = 0; b < robot_.buses.size(); ++b) {
    buses +=
        fmt::format("{}{} = {} ({:.0f} % predicted load)", b == 0 ? "" : ", ", robot_.buses[b].name,
                    robot_.buses[b].can, 100.0 * predicted_bus_load(robot_, static_cast<int>(b)));
  }
  const std::string pace = options_.lockstep ? "in lock step" : "in real time";
  spdlog::info("{}, {} joints, {:g} Hz {}, session {}; {}; {}", robot_.name, robot_.size(),
               robot_.rate_hz, pace, session_, buses,
               options_.lockstep ? "no clock" : said(grant_, options_.realtime_priority));
}

int DriverProcess::run(const volatile std::sig_atomic_t& stop) {
  say_start();
  const std::string missing = call_roll(robot_, bus_pointers_, options_.patience_s, stop);
  if (stop != 0) return kExitDone;
  if (!missing.empty()) {
    spdlog::error("no answer for {:g} s from {}", options_.patience_s, missing);
    return kExitNobodyThere;
  }
  int exit_status = kExitDone;
  if (options_.lockstep) {
    exit_status = run_lockstep(stop);
  } else {
    run_realtime(stop);
  }
  publish_status();
  say_end();
  return exit_status;
}

void DriverProcess::say_end() const {
  std::int64_t refused = 0;
  for (const std::int64_t count : status_.commands_refused) refused += count;
  std::int64_t lost = 0;
  for (const std::int32_t count : status_.replies_lost) lost += count;
  spdlog::info("{} cycles; commands: {} accepted, {} refused, {} missing; replies lost: {}",
               status_.cycles, status_.commands_accepted, refused, status_.commands_missing, lost);
  if (options_.lockstep) return;
  spdlog::info(
      "{} late and {} overrun cycles; start late by 50 %: {} us, 99 %: {} us, at most {} us; "
      "answer after 50 %: {} us, 99 %: {} us, at most {} us",
      status_.late_cycles, status_.overrun_cycles, status_.lateness_p50_ns / 1000,
      status_.lateness_p99_ns / 1000, status_.lateness_max_ns / 1000, status_.answer_p50_ns / 1000,
      status_.answer_p99_ns / 1000, status_.answer_max_ns / 1000);
}

bool DriverProcess::finished(const volatile std::sig_atomic_t& stop) const {
  if (stop != 0) return true;
  if (options_.cycles > 0 && cycle_ >= options_.cycles) return true;
  const double arm_time_s = options_.lockstep
                                ? static_cast<double>(cycle_ * period_ns_) * 1e-9
                                : static_cast<double>(monotonic_ns() - first_ns_) * 1e-9;
  return options_.duration_s > 0.0 && arm_time_s >= options_.duration_s - 1e-9;
}

// --- realtime ------------------------------------------------------------------------------------

void DriverProcess::run_realtime(const volatile std::sig_atomic_t& stop) {
  first_ns_ = monotonic_ns();
  loop_.start();
  while (!finished(stop)) realtime_cycle();
  driver_->request_shut_down();
  const std::int64_t end_ns = monotonic_ns() + static_cast<std::int64_t>(kShutDownPatience_s * 1e9);
  while (!driver_->shut_down() && monotonic_ns() < end_ns) realtime_cycle();
  spdlog::info(driver_->shut_down() ? "every drive reports disabled"
                                    : "some drive does not report disabled: its own watchdog acts");
}

void DriverProcess::realtime_cycle() {
  const std::int64_t lateness_ns = loop_.wait();
  const std::int64_t start_ns = monotonic_ns();
  if (cycle_ == 0) first_ns_ = start_ns;
  lateness_.add(lateness_ns);
  if (lateness_ns > period_ns_ / 10) ++late_cycles_;
  arm_plane_->handle_waiting();  // an answer that came while we slept is still in time

  driver_->transmit(start_ns - first_ns_);
  wait_for_replies(start_ns + static_cast<std::int64_t>(kReplyShare * period_ns_));
  publish_state(driver_->finish_cycle());
  wait_for_answer(loop_.deadline_ns() - kSpin_ns);

  const bool overrun = lateness_ns >= period_ns_ || monotonic_ns() > loop_.deadline_ns();
  if (overruns_.too_many(overrun)) driver_->request_hold(joint_state_t::FAULT_OVERRUN);
  ++cycle_;
  if (cycle_ % channels::kDriverStatusEvery == 0) publish_status();
}

void DriverProcess::wait_for_replies(std::int64_t deadline_ns) {
  driver_->poll();
  while (!driver_->complete() && wait_readable(bus_pointers_, deadline_ns)) driver_->poll();
}

void DriverProcess::wait_for_answer(std::int64_t deadline_ns) {
  const std::array<int, 1> arm{arm_plane_->descriptor()};
  do {
    arm_plane_->handle_waiting();
  } while (!answered_ && wait_readable(arm, deadline_ns));
}

// --- lock step -----------------------------------------------------------------------------------

int DriverProcess::run_lockstep(const volatile std::sig_atomic_t& stop) {
  while (!finished(stop)) {
    driver_->transmit(cycle_ * period_ns_);
    if (!lockstep_replies(stop)) {
      if (stop != 0) break;
      spdlog::error("no TOCK from the simulator for {:g} s (cycle {})", options_.patience_s,
                    cycle_);
      return kExitNobodyThere;
    }
    const joint_state_t& state = driver_->finish_cycle();
    publish_state(state);
    if (!lockstep_answer(stop)) {
      if (stop != 0) break;
      spdlog::error("no answer from the controller for {:g} s (state {})", options_.patience_s,
                    state.seq);
      return kExitNobodyThere;
    }
    ++cycle_;
    if (cycle_ % channels::kDriverStatusEvery == 0) publish_status();
  }
  return kExitDone;
}

bool DriverProcess::lockstep_replies(const volatile std::sig_atomic_t& stop) {
  const std::int64_t give_up_ns =
      monotonic_ns() + static_cast<std::int64_t>(options_.patience_s * 1e9);
  std::int64_t repeat_ns = monotonic_ns() + kRepeat_ns;
  driver_->poll();
  while (!driver_->complete()) {
    if (stop != 0 || monotonic_ns() > give_up_ns) return false;
    if (!wait_readable(bus_pointers_, repeat_ns)) {
      driver_->repeat_tick();
      repeat_ns = monotonic_ns() + kRepeat_ns;
    }
    driver_->poll();
  }
  return true;
}

bool DriverProcess::lockstep_answer(const volatile std::sig_atomic_t& stop) {
  const std::int64_t give_up_ns =
      monotonic_ns() + static_cast<std::int64_t>(options_.patience_s * 1e9);
  while (!answered_) {
    if (stop != 0 || monotonic_ns() > give_up_ns) return false;
    wait_for_answer(monotonic_ns() + kRepeat_ns);
    if (!answered_) arm_plane_->publish(channels::kJointState, *published_);
  }
  return true;
}

// --- messages ------------------------------------------------------------------------------------

void DriverProcess::on_torque(const joint_torque_t& command) {
  const bool of_this_state = published_ != nullptr && command.state_seq == published_->seq;
  // In lock step a state that was published twice is answered twice; the second answer, and what is
  // left from the state before, must not count as refused commands.
  if (options_.lockstep && (!of_this_state || answered_)) return;
  const int verdict = driver_->accept(command);
  const bool stranger = verdict == driver_status_t::VERDICT_SIZE ||
                        verdict == driver_status_t::VERDICT_SESSION ||
                        verdict == driver_status_t::VERDICT_CONTROLLER;
  if (!of_this_state || stranger || answered_) return;
  answered_ = true;
  if (!options_.lockstep) answers_.add(monotonic_ns() - published_ns_);
}

void DriverProcess::publish_state(const joint_state_t& state) {
  published_ = &state;
  published_ns_ = options_.lockstep ? 0 : monotonic_ns();
  answered_ = false;
  arm_plane_->publish(channels::kJointState, state);
  user_plane_->publish(channels::kJointState, state);
  reporter_->note(state);
  tell_configuration_problem(state);
}

void DriverProcess::tell_configuration_problem(const joint_state_t& state) {
  const bool wrong = state.fault == joint_state_t::FAULT_CONFIGURATION;
  // Nothing is enabled then: the cycle may take the time for a line.
  if (wrong && !told_) spdlog::error("{}", driver_->configuration_problem());
  told_ = wrong;
}

void DriverProcess::publish_status() {
  driver_->fill_status(&status_);
  status_.realtime_priority = grant_.fifo && grant_.locked_memory ? 1 : 0;
  status_.late_cycles = late_cycles_;
  status_.overrun_cycles = overruns_.count();
  status_.lateness_p50_ns = lateness_.quantile(0.5);
  status_.lateness_p99_ns = lateness_.quantile(0.99);
  status_.lateness_p999_ns = lateness_.quantile(0.999);
  status_.lateness_max_ns = lateness_.max();
  status_.answer_p50_ns = answers_.quantile(0.5);
  status_.answer_p99_ns = answers_.quantile(0.99);
  status_.answer_max_ns = answers_.max();
  user_plane_->publish(channels::kDriverStatus, status_);
  ++status_.seq;
}

}  // namespace limber
