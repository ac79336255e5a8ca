#include "drivers/arm_driver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/problem_text.h"
#include "drivers/bus_load.h"
#include "drivers/can/lockstep_frame.h"
#include "drivers/driver_setup.h"
#include "lcmtypes/channels.h"

namespace limber {
namespace {

constexpr double kShutDownBraking_s = 0.3;
constexpr int kBatchesPerPoll = 16;  // a flooded bus must not keep the cycle

std::vector<BusEnd> bus_ends(const Robot& robot, const std::vector<CanBus*>& buses,
                             std::int64_t session) {
  check_robot(robot, buses.size(), session);
  std::vector<BusEnd> ends;
  for (std::size_t b = 0; b < buses.size(); ++b)
    ends.emplace_back(buses[b], robot.buses[b], checked_bus_load(robot, static_cast<int>(b)));
  return ends;
}

constexpr int kMostDetail = std::numeric_limits<std::uint16_t>::max();

std::uint16_t short_of(std::int64_t number) noexcept {
  return static_cast<std::uint16_t>(std::clamp<std::int64_t>(number, 0, kMostDetail));
}

const char* text_of(Contradiction contradiction) noexcept {
  switch (contradiction) {
    case Contradiction::kVelocity:
      return "the velocity does not fit the positions; check the encoder and the drive's scaling";
    case Contradiction::kLinkVelocity:
      return "the link's velocity does not fit its positions; check the link encoder";
    case Contradiction::kTorque:
      return "the torque is opposite to the command, or far beyond it; check the drive's torque "
             "constant and phases";
    case Contradiction::kNone:
      break;
  }
  return "";
}

}  // namespace

ArmDriver::ArmDriver(const Robot& robot, const std::vector<CanBus*>& buses,
                     const ArmDriverOptions& options)
    : rate_hz_(robot.rate_hz),
      motors_(robot.motors()),
      lockstep_(options.lockstep),
      session_(options.session),
      buses_(bus_ends(robot, buses, options.session)),
      drives_(robot, options.bridged_cycles),
      supervisor_(robot),
      gate_(gate_limits(robot, options.session)),
      controller_watch_(options.bridged_cycles),
      window_ns_(reply_window_ns_of(robot)),
      least_round_trip_ns_(options.lockstep ? least_round_trip_ns_of(robot) : 0),
      cycle_(options.first_cycle - 1),
      simulated_(!options.lockstep && robot.on_virtual_buses()) {
  drives_.add_bus_frames(&buses_);
  if (robot.has_tip_sensor) tip_sensor_.emplace(robot.tip_sensor, options.bridged_cycles);
  if (robot.emergency_stop) emergency_stop_.emplace(*robot.emergency_stop, robot.rate_hz);
  state_.session = session_;
  state_.period_ns = std::llround(1e9 / rate_hz_);
  state_.num_joints = static_cast<std::int8_t>(robot.size());
}

// --- 1. transmit ---------------------------------------------------------------------------------

void ArmDriver::transmit(std::int64_t time_ns, std::int64_t stamp_ns) noexcept {
  drives_.begin_cycle();
  if (tip_sensor_) tip_sensor_->begin_cycle();
  ++cycle_;
  time_ns_ = time_ns;
  stamp_ns_ = stamp_ns;
  receive(/*before_commands=*/true);
  gate_.next_cycle();
  controller_watch_.next_cycle(gate_.leased());
  if (controller_watch_.lost()) drives_.apply(DriveEvent::kControllerLost);
  if (shutting_down_) advance_shut_down();

  for (BusEnd& bus : buses_) bus.clear();
  drives_.add_commands(&buses_);
  drives_.ask_for_settings(&buses_);
  if (tip_sensor_) {
    buses_[tip_sensor_->bus()].add(tip_sensor_->next_frame());
  }
  for (BusEnd& bus : buses_) {
    bus.send();
    bus.expect_tock(cycle_);
  }
  if (lockstep_) repeat_tick();
}

void ArmDriver::advance_shut_down() noexcept {
  drives_.apply(DriveEvent::kShutDown);
  if (drives_.cycles_in_state() >= cycles_of(kShutDownBraking_s, rate_hz_))
    drives_.apply(DriveEvent::kRequestOff);
}

void ArmDriver::repeat_tick() noexcept {
  for (BusEnd& bus : buses_) {
    if (!bus.tocked()) bus.send_tick();
  }
}

void ArmDriver::set_receive_filters() {
  for (std::size_t b = 0; b < buses_.size(); ++b) {
    std::vector<CanFilter> filters = drives_.receive_filters(b);
    if (tip_sensor_ && tip_sensor_->bus() == b) tip_sensor_->add_receive_filters(&filters);
    if (emergency_stop_) emergency_stop_->add_receive_filters(b, &filters);
    if (lockstep_)
      filters.insert(filters.end(), {exactly(lockstep::kTickId), exactly(lockstep::kTockId)});
    buses_[b].set_receive_filters(filters);
    buses_[b].count_from_here();
  }
}

// --- 2. poll -------------------------------------------------------------------------------------

void ArmDriver::poll() noexcept { receive(/*before_commands=*/false); }

// A frame is late if it is here before this cycle's commands are, or too soon after them.
void ArmDriver::receive(bool before_commands) noexcept {
  const std::int64_t soonest_ns = stamp_ns_ + least_round_trip_ns_;
  const std::int64_t until_ns = before_commands ? stamp_ns_ : stamp_ns_ + window_ns_;
  for (std::size_t b = 0; b < buses_.size(); ++b) {
    for (int batch = 0; batch < kBatchesPerPoll; ++batch) {
      const std::span<const CanFrame> frames = buses_[b].receive(until_ns);
      for (const CanFrame& frame : frames) {
        const bool too_soon = frame.timestamp_ns != 0 && frame.timestamp_ns < soonest_ns;
        route(b, frame, before_commands || too_soon);
      }
      if (!buses_[b].more()) break;
    }
  }
}

void ArmDriver::route(std::size_t bus, const CanFrame& frame, bool late) noexcept {
  if (frame.error || buses_[bus].take_lockstep(frame)) return;
  if (tip_sensor_ && tip_sensor_->is_mine(bus, frame)) {
    tip_sensor_->receive(frame, late);
  } else if (emergency_stop_ && emergency_stop_->is_mine(bus, frame)) {
    emergency_stop_->receive(frame);
  } else if (!drives_.receive(bus, frame, late)) {
    buses_[bus].count_foreign();
    // This driver's own frames do not come back to it.
    const int commanded = drives_.record_foreign(bus, frame);
    if (commanded >= 0) drives_.apply(DriveEvent::kForeignCommand, commanded);
  }
}

bool ArmDriver::complete() const noexcept {
  if (lockstep_) return std::ranges::all_of(buses_, &BusEnd::tocked);
  return drives_.all_answered() && (!tip_sensor_ || tip_sensor_->settled());
}

// --- 3. finish_cycle -----------------------------------------------------------------------------

const joint_state_t& ArmDriver::finish_cycle() noexcept {
  drives_.close_cycle(cycle_, 1e-9 * static_cast<double>(time_ns_));
  if (tip_sensor_) tip_sensor_->close_cycle();
  if (emergency_stop_) check_emergency_stop();
  supervisor_.check(buses_, &drives_);
  drives_.update_torque_present();
  if ((cycle_ + 1) % channels::kDriverStatusEvery == 0) {
    for (BusEnd& bus : buses_) bus.close_interval(channels::kDriverStatusEvery / rate_hz_);
  }
  state_.seq = cycle_;
  state_.time_ns = time_ns_;
  drives_.write_state(&state_);
  if (tip_sensor_) tip_sensor_->write_state(&state_);
  return state_;
}

void ArmDriver::check_emergency_stop() noexcept {
  emergency_stop_->close_cycle();
  if (emergency_stop_->stopped()) drives_.apply(DriveEvent::kEmergencyStop);
  if (emergency_stop_->power_is_off()) drives_.apply(DriveEvent::kEmergencyOff);
  state_.emergency_stop = emergency_stop_->state();
}

// --- 4. accept -----------------------------------------------------------------------------------

int ArmDriver::accept(const joint_command_t& command) noexcept {
  const int verdict = gate_.judge(command, situation());
  controller_watch_.note(verdict);
  if (verdict == driver_status_t::VERDICT_ACCEPTED) {
    drives_.set_gravity(command);
    if (!shutting_down_) drives_.follow(command);
  } else if (gate_.refused_too_often()) {
    refused_for_ = verdict;
    drives_.apply(DriveEvent::kCommandRefused);
  }
  return verdict;
}

GateSituation ArmDriver::situation() const noexcept {
  GateSituation now;
  now.state_seq = cycle_;
  drives_.write_situation(&now);
  std::copy_n(state_.v, kMaxJoints, now.velocity.begin());
  return now;
}

std::uint16_t ArmDriver::fault_detail() const noexcept {
  const auto joint = static_cast<std::size_t>(std::max<int>(state_.fault_joint, 0));
  const bool of_joint = state_.fault_joint >= 0;
  switch (state_.fault) {
    case joint_state_t::FAULT_DRIVE_ERROR:
      return of_joint ? static_cast<std::uint16_t>(state_.drive_status[joint]) : 0;
    case joint_state_t::FAULT_FEEDBACK:
      return of_joint ? static_cast<std::uint16_t>(drives_.joints()[joint].contradiction()) : 0;
    case joint_state_t::FAULT_TEMPERATURE:
      if (!of_joint) return 0;
      return static_cast<std::uint16_t>(std::clamp<double>(
          std::round(state_.temperature_degC[joint]), 0.0, DriveWarning::kMost_degC));
    case joint_state_t::FAULT_REPLY_LOST:
      return short_of(drives_.silent_cycles(state_.fault_joint));
    case joint_state_t::FAULT_OVERRUN:
      return short_of(overrun_ns_ / 1'000'000);
    case joint_state_t::FAULT_COMMAND_REFUSED:
      return static_cast<std::uint16_t>(refused_for_);
    case joint_state_t::FAULT_BUS:
      break;
    default:
      return 0;
  }
  for (std::size_t b = 0; b < buses_.size(); ++b) {
    if (buses_[b].lost()) return static_cast<std::uint16_t>(b << 8U | buses_[b].state());
  }
  return 0;
}

std::string ArmDriver::fault_text(int fault, int joint, std::uint16_t detail) const {
  switch (fault) {
    case joint_state_t::FAULT_CONFIGURATION:
      return drives_.configuration_problem();
    case joint_state_t::FAULT_DRIVE_ERROR:
      return joint < 0 ? "" : drives_.error_text(static_cast<std::size_t>(joint), detail);
    case joint_state_t::FAULT_TEMPERATURE:
      return joint < 0 ? "" : drives_.heat_text(static_cast<std::size_t>(joint), detail);
    case joint_state_t::FAULT_REPLY_INVALID:
    case joint_state_t::FAULT_FOREIGN_COMMAND:
      return joint < 0 ? "" : drives_.address_text(joint);
    case joint_state_t::FAULT_REPLY_LOST:
      return lost_text(joint, detail);
    case joint_state_t::FAULT_FEEDBACK:
      return text_of(static_cast<Contradiction>(detail));
    default:
      return detail == 0 ? "" : detail_text(fault, detail);
  }
}

std::string ArmDriver::lost_text(int joint, int cycles) const {
  const std::string who = drives_.address_text(joint);
  const std::string often = "ten replies within a second missing or impossible";
  const std::string silent = cycles == kMostDetail ? "no reply since the start"
                                                   : fmt::format("no reply for {} cycles", cycles);
  std::string text = cycles < 2
                         ? fmt::format("{}: {}", who, often)
                         : fmt::format("{}{}: {}", joint < 0 ? "all drives, " : "", who, silent);
  if (simulated_)
    text += "; these drives are simulated: see whether limber-sim ended or stood still";
  return text;
}

std::string ArmDriver::detail_text(int fault, std::uint16_t detail) const {
  if (fault == joint_state_t::FAULT_OVERRUN)
    return fmt::format("limber-driver stood still, or took, {} ms in a cycle of {:g} ms", detail,
                       1e3 / rate_hz_);
  if (fault == joint_state_t::FAULT_COMMAND_REFUSED) {
    const Problem* problem = find_problem(problems::kGate, detail);
    return problem == nullptr ? "" : std::string(problem->code) + ": " + problem->what;
  }
  if (fault != joint_state_t::FAULT_BUS) return "";
  const std::string name = buses_[std::min<std::size_t>(detail >> 8U, buses_.size() - 1)].name();
  const Problem* problem = find_problem(problems::kBus, detail & 0xFFU);
  return problem == nullptr ? "" : name + ": " + problem->what + "; " + problem->remedy;
}

// --- status --------------------------------------------------------------------------------------

void ArmDriver::fill_status(driver_status_t* status) const noexcept {
  status->time_ns = time_ns_;
  status->session = session_;
  status->lockstep = lockstep_ ? 1 : 0;
  status->cycles = cycle_ + 1;
  controller_watch_.write_status(status);
  drives_.write_status(status);
  if (tip_sensor_) tip_sensor_->write_status(status);
  status->num_buses = static_cast<std::int8_t>(buses_.size());
  for (std::size_t b = 0; b < buses_.size(); ++b) buses_[b].write_status(b, status);
}

}  // namespace limber
