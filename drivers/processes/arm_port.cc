#include "drivers/processes/arm_port.h"

#include <spdlog/spdlog.h>

#include "common/clock.h"
#include "lcmtypes/channels.h"

namespace limber {

ArmPort::ArmPort(const Robot& robot, const ArmDriverOptions& options, LcmPort* user_plane,
                 StateReporter* reporter)
    : lockstep_(options.lockstep),
      user_plane_(user_plane),
      reporter_(reporter),
      arm_plane_(arm_plane_url(), ArmPlaneEnd::kDriver) {
  arm_plane_.subscribe<joint_command_t>(channels::kJointTorque,
                                        [this](const joint_command_t& c) { on_command(c); });
  for (const BusConfig& bus : robot.buses) {
    const Stamps stamps = lockstep_ ? Stamps::kOfSender : Stamps::kOnArrival;
    buses_.push_back(open_can_bus(bus.can, bus.fd, stamps, bus.bitrate_bps));
    bus_pointers_.push_back(buses_.back().get());
  }
  driver_ = std::make_unique<ArmDriver>(robot, bus_pointers_, options);
  reporter_->set_fault_text([this](int fault, int joint, std::uint16_t detail) {
    return driver_->fault_text(fault, joint, detail);
  });
  reporter_->set_warning_text([this](int motor, const DriveWarning& warning) {
    return driver_->warning_text(motor, warning);
  });
}

void ArmPort::publish_state(const joint_state_t& state) {
  published_ = &state;
  published_ns_ = monotonic_ns();
  answered_ = false;
  arm_plane_.publish(channels::kJointState, state);
  user_plane_->publish(channels::kJointState, state);
  reporter_->note(state, driver_->fault_detail(), controller_fault_);
  for (int motor = 0; motor < driver_->motors(); ++motor)
    reporter_->note_warning(motor, driver_->warning(motor));
  log_configuration(state);
}

void ArmPort::repeat_state() { arm_plane_.publish(channels::kJointState, *published_); }

bool ArmPort::wait_for_answer(std::int64_t deadline_ns) {
  // The clock as well: whoever floods the plane must not keep the loop here.
  do {
    read_commands();
  } while (!answered_ && monotonic_ns() < deadline_ns && arm_plane_.wait(deadline_ns));
  return answered_;
}

void ArmPort::on_command(const joint_command_t& command) {
  const bool of_this_state = published_ != nullptr && command.state_seq == published_->seq;
  // In lock step a state that was published twice is answered twice; the second answer, and what is
  // left from the state before, must not count as refused commands.
  if (lockstep_ && (!of_this_state || answered_)) return;
  const int verdict = driver_->accept(command);
  if (verdict == driver_status_t::VERDICT_CONTROLLER)
    reporter_->note_other_controller(command.controller, driver_->controller());
  const bool foreign = verdict == driver_status_t::VERDICT_SIZE ||
                       verdict == driver_status_t::VERDICT_SESSION ||
                       verdict == driver_status_t::VERDICT_CONTROLLER;
  if (!foreign) controller_fault_ = command.mode == controller_status_t::MODE_FAULT;
  if (!of_this_state || foreign || answered_) return;
  answered_ = true;
  if (!lockstep_) timing_.answers.add(monotonic_ns() - published_ns_);
}

void ArmPort::log_configuration(const joint_state_t& state) {
  // Nothing is enabled then: the cycle may take the time for a line.
  const bool wrong = state.fault == joint_state_t::FAULT_CONFIGURATION;
  if (wrong && !wrong_) log_problem(driver_->configuration_problem());
  wrong_ = wrong;
  if (configuring_ && state.drive_state == joint_state_t::DRIVE_OFF) {
    problem_logged_.clear();
    for (const std::string& line : driver_->configuration_warnings())
      spdlog::warn("warning: {}", line);
  }
  configuring_ = state.drive_state == joint_state_t::DRIVE_CONFIGURING;
}

void ArmPort::log_problem(const std::string& problem) {
  if (problem != problem_logged_) spdlog::error("error: {}", problem);
  problem_logged_ = problem;
}

void ArmPort::publish_status() {
  driver_->fill_status(&status_);
  timing_.write_status(&status_);
  status_.messages_undecodable = arm_plane_.undecodable();
  user_plane_->publish(channels::kDriverStatus, status_);
  ++status_.seq;
}

}  // namespace limber
