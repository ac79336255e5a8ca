#include "drivers/processes/driver_process.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/config_error.h"
#include "common/program.h"
#include "drivers/bus_load.h"
#include "drivers/can/link_details.h"
#include "drivers/drive/drive_discovery.h"
#include "drivers/interface_check.h"
#include "drivers/processes/lockstep_runner.h"
#include "drivers/processes/realtime_runner.h"
#include "robots/loader/choose_buses.h"
#include "robots/loader/load_robot.h"

namespace limber {
namespace {

Robot load(const DriverProcessOptions& options) {
  Robot robot = load_robot(options.robot).robot;
  if (options.rate_hz > 0.0) robot.rate_hz = options.rate_hz;
  choose_buses(options.buses, &robot);
  return robot;
}

std::vector<RunLock> lock_buses(const Robot& robot) {
  std::vector<RunLock> locks;
  require_local(arm_plane_url(), !robot.on_virtual_buses());
  locks.emplace_back("driver on " + arm_plane_url());
  for (const BusConfig& bus : robot.buses) locks.emplace_back("driver of " + bus.can);
  return locks;
}

RealtimeGrant request_priority(const DriverProcessOptions& options) {
  if (options.realtime_priority == 0) return {};
  if (!in_lockstep(options.pace)) return ask_for_realtime(options.realtime_priority);
  return {.reason = raise_priority(options.pace == Pace::kPaced)};
}

std::string text_of(Pace pace, const RealtimeGrant& grant, int priority) {
  if (in_lockstep(pace)) return pace == Pace::kPaced ? "not faster than the clock" : "no clock";
  if (priority == 0) return "real-time priority not requested";
  if (grant.fifo && grant.locked_memory)
    return fmt::format("real-time priority {} and locked memory granted", priority);
  return "NOT real-time: " + grant.reason;
}

}  // namespace

DriverProcess::DriverProcess(const DriverProcessOptions& options)
    : options_(options),
      robot_(load(options)),
      locks_(lock_buses(robot_)),
      black_box_(open_black_box("driver-" + robot_.name, robot_.rate_hz, options.pace)),
      reporter_(robot_.driven_names()),
      user_plane_(user_plane_url(), LcmPort::Use::kPublishOnly),
      grant_(request_priority(options)),
      port_(robot_, ArmDriverOptions{options.session, lockstep()}, &user_plane_, &reporter_) {
  port_.status().realtime_priority = grant_.fifo && grant_.locked_memory ? 1 : 0;
  port_.set_black_box(black_box_.get());
  user_plane_.set_black_box(black_box_.get());
  reporter_.set_on_fault([this](const char* code) { keep(black_box_.get(), code); });
}

int DriverProcess::run(const volatile std::sig_atomic_t& stop) {
  log_start();
  check_interfaces();
  if (!lockstep()) check_bus_is_free();
  const std::string missing = discover_drives(
      robot_, port_.buses(), lockstep(), options_.patience_s, stop, [](const std::string& silent) {
        spdlog::warn(
            "warning: no answer yet from {}; check power, bit rate, termination and ids; still "
            "waiting",
            silent);
      });
  if (stop != 0) return kExitDone;
  if (!missing.empty()) {
    spdlog::error("no answer for {:g} s from {}", options_.patience_s, missing);
    return kExitFailed;
  }
  if (!lockstep()) {
    const std::string twins = find_twins(robot_, port_.buses());
    if (!twins.empty()) {
      throw ConfigError(robot_.name + ": two motors answer to one id: " + twins +
                        "; disconnect one and give it another id");
    }
    measure_delay();
  }
  port_.driver().set_receive_filters();
  const bool done = run_cycles(stop);
  port_.publish_status();
  reporter_.stop();
  log_end();
  return done ? kExitDone : kExitFailed;
}

bool DriverProcess::run_cycles(const volatile std::sig_atomic_t& stop) {
  const RunLength length{options_.cycles, options_.duration_s};
  if (!lockstep()) {
    RealtimeRunner(&port_, robot_.rate_hz, length).run(stop);
    return true;
  }
  LockstepRunner runner(&port_, robot_.rate_hz, options_.patience_s, length);
  if (options_.pace == Pace::kPaced) runner.pace(grant_.reason);
  runner.wait_for(ReaderBacklog(options_.readers));
  return runner.run(stop);
}

void DriverProcess::check_interfaces() const {
  constexpr std::string_view kSocketCan = "socketcan:";
  for (const BusConfig& bus : robot_.buses) {
    if (bus.can.rfind(kSocketCan, 0) != 0) continue;
    const std::optional<LinkDetails> link = read_link_details(bus.can.substr(kSocketCan.size()));
    if (!link || !link->has_bit_timing())
      spdlog::debug("{}: no bit timing to compare with robot.yaml ({})", bus.can,
                    link ? link->kind : "the kernel does not tell");
    if (!link) continue;
    const InterfaceFindings found = compare(bus, *link);
    for (const std::string& line : found.doubtful) spdlog::warn("warning: {}: {}", bus.can, line);
    if (found.wrong.empty()) continue;
    throw ConfigError(fmt::format("{}: {}. `limber doctor {}` prints the commands that set it",
                                  bus.can, fmt::join(found.wrong, "; "), robot_.name));
  }
}

void DriverProcess::check_bus_is_free() {
  const std::string commanded = find_foreign_command(robot_, port_.buses());
  if (commanded.empty()) return;
  throw ConfigError(robot_.name + ": another program commands " + commanded +
                    "; stop it first: two masters would fight for the arm");
}

void DriverProcess::measure_delay() {
  const std::int64_t window_ns = port_.driver().reply_window_ns();
  std::int64_t least_ns = 0;
  const std::vector<RoundTrip> trips = measure_round_trips(robot_, port_.buses());
  for (std::size_t b = 0; b < trips.size(); ++b) {
    const RoundTrip& trip = trips[b];
    if (trip.answered == 0) continue;
    const std::string& name = robot_.buses[b].name;
    spdlog::info("bus {}: round trip {:.3f} to {:.3f} ms, {} of {} answered", name,
                 1e-6 * static_cast<double>(trip.least_ns),
                 1e-6 * static_cast<double>(trip.longest_ns), trip.answered, kRoundTrips);
    if (trip.least_ns > window_ns) {
      throw ConfigError::at(
          robot_.name, 0, "buses." + name,
          fmt::format("a reply takes {:.2f} ms, the driver waits {:.2f} ms at {:g} Hz: every state "
                      "would be a cycle old or more. At most {:.0f} Hz, or a faster adapter",
                      1e-6 * static_cast<double>(trip.least_ns),
                      1e-6 * static_cast<double>(window_ns), robot_.rate_hz,
                      std::floor(kLatestReply * 1e9 / static_cast<double>(trip.longest_ns))));
    }
    least_ns = least_ns == 0 ? trip.least_ns : std::min(least_ns, trip.least_ns);
  }
  // Half of it: a reply that comes sooner answers the command before.
  port_.driver().set_least_round_trip(least_ns / 2);
}

void DriverProcess::log_start() const {
  std::string buses;
  for (std::size_t b = 0; b < robot_.buses.size(); ++b) {
    buses += fmt::format("{}{} = {} ({:.0f} % predicted load)", b == 0 ? "" : ", ",
                         robot_.buses[b].name, bus_text(robot_.buses[b].can),
                         100.0 * expected_bus_load(robot_, static_cast<int>(b)));
  }
  spdlog::info("{}, {} joints{}, {:g} Hz {}, session {}; {}; {}", robot_.name, robot_.size(),
               robot_.hand ? " and a hand" : "", robot_.rate_hz,
               lockstep() ? "in lock step" : "in real time", options_.session, buses,
               text_of(options_.pace, grant_, options_.realtime_priority));
}

void DriverProcess::log_end() const {
  const driver_status_t& status = port_.status();
  std::int64_t refused = 0;
  for (const std::int64_t count : status.commands_refused) refused += count;
  std::int64_t lost = 0;
  for (const std::int64_t count : status.replies_lost) lost += count;
  spdlog::info("{} cycles; commands: {} accepted, {} refused, {} missing; replies lost: {}",
               status.cycles, status.commands_accepted, refused, status.commands_missing, lost);
  if (lockstep()) return;
  spdlog::info(
      "{} late and {} overrun cycles; start late by 50 %: {} us, 99 %: {} us, at most {} us; "
      "answer after 50 %: {} us, 99 %: {} us, at most {} us",
      status.late_cycles, status.overrun_cycles, status.lateness_p50_ns / 1000,
      status.lateness_p99_ns / 1000, status.lateness_max_ns / 1000, status.answer_p50_ns / 1000,
      status.answer_p99_ns / 1000, status.answer_max_ns / 1000);
}

}  // namespace limber
