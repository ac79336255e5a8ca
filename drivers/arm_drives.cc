#include "drivers/arm_drives.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "drivers/driver_setup.h"
#include "drivers/protocols/cycle_frames.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

constexpr double kSettling_s = 0.1;

std::string line_about(const Drive& motor, const std::string& words) {
  const JointConfig& joint = motor.link().joint();
  return fmt::format("{} ({}): {}", joint.name, joint.drive.protocol->address(joint.drive), words);
}

std::string out_of_range_line(const ArmJoint& joint) {
  const JointLink& link = joint.motors().front().link();
  const JointConfig& config = link.joint();
  if (!link.turns().known) {
    const auto [first, second] = link.turns().candidates;
    return fmt::format(
        "{}: reads {:.4g}, and may be at {:.4g} or {:.4g}, both within its limits {:g} to {:g}: "
        "the drives cannot be enabled; its drive keeps a single turn: turn it to where only "
        "one angle fits and start again, tighten its limits, or write keeps_turns: true for its "
        "motor if the drive counts turns without power",
        config.name, link.theta(), first, second, config.position_min, config.position_max);
  }
  return fmt::format(
      "{}: at {:.4g}, outside its limits {:g} to {:g}: the drives cannot be enabled; "
      "move it by hand, or correct its offset_rad and sign",
      config.name, joint.q(), config.position_min, config.position_max);
}

std::string whole_turn_line(const JointLink& link) {
  return fmt::format(
      "{}: its drive reads a whole turn off, which is taken out: {:.4g} instead of {:.4g}, the "
      "only "
      "one of both within its limits",
      link.joint().name, link.theta(), link.theta() - 2.0 * std::numbers::pi * link.turns().turns);
}

}  // namespace

ArmDrives::ArmDrives(const Robot& robot, int bridged_cycles)
    : has_hand_(robot.hand.has_value()), settling_cycles_(cycles_of(kSettling_s, robot.rate_hz)) {
  for (const JointConfig& joint : robot.driven()) {
    joints_.emplace_back(robot, joint, bridged_cycles);
    rest_torque_.emplace_back(joint.torque_limit_Nm, robot.rate_hz);
  }
  for (const ArmJoint& joint : joints_) {
    for (const Drive& motor : joint.motors()) ++motors_on_bus_[motor.bus()];
  }
}

// --- state ---------------------------------------------------------------------------------------

void ArmDrives::apply(DriveEvent event, int joint) noexcept {
  const DriveState from = machine_.state();
  if (!machine_.apply(event, joint)) return;
  enabling_ended_.store(event == DriveEvent::kEnableTimedOut, std::memory_order_relaxed);
  cycles_in_state_ = 0;
  for (std::size_t i = 0; i < joints_.size(); ++i)
    joints_[i].enter(machine_.state(), torque_present_[i], held_after(event, i));
  if (in(DriveState::kOn) && from == DriveState::kEnabling) {
    torque_.fill({});
    torque_present_.fill({});
  }
}

// A controller that is gone leaves what it had right: what kept a resting joint in its place. Any
// other event may be one of the joint itself, whose rest may be that of its encoder alone.
JointTorque ArmDrives::held_after(DriveEvent event, std::size_t joint) const noexcept {
  const bool controller_gone = event == DriveEvent::kControllerLost ||
                               event == DriveEvent::kCommandRefused ||
                               event == DriveEvent::kOverrun;
  const RestTorque& rest = rest_torque_[joint];
  const double tau = controller_gone && rest.known() ? rest.mean() : tau_gravity_[joint];
  return {tau, torque_[joint].preload};
}

bool ArmDrives::follows_torque() const noexcept {
  return in(DriveState::kOn) || (machine_.holding() && machine_.acknowledged());
}

std::string ArmDrives::configuration_problem() const {
  for (const ArmJoint& joint : joints_) {
    for (const Drive& motor : joint.motors()) {
      if (motor.configuration_wrong()) return line_about(motor, motor.configuration_problem());
    }
  }
  return "";
}

std::vector<std::string> ArmDrives::configuration_warnings() const {
  std::vector<std::string> lines;
  for (const ArmJoint& joint : joints_) {
    for (const Drive& motor : joint.motors()) {
      for (const std::string& warning : motor.configuration_warnings())
        lines.push_back(line_about(motor, warning));
    }
    if (joint.out_of_range()) lines.push_back(out_of_range_line(joint));
    const JointLink& link = joint.motors().front().link();
    if (link.turns().turns != 0) lines.push_back(whole_turn_line(link));
  }
  return lines;
}

DriveWarning ArmDrives::warning(int motor) const noexcept { return motor_at(motor).warning(); }

std::string ArmDrives::warning_text(int motor, const DriveWarning& warning) const {
  const Drive& drive = motor_at(motor);
  std::string words;
  const auto add = [&](const std::string& word) { words += (words.empty() ? "" : "; ") + word; };
  const DriveConfig& config = drive.link().joint().drive;
  if (warning.too_hot) {
    add(
        fmt::format("{} degC, more than {:g} (limit_temperature_degC): not used again before it is "
                    "down to {:g}",
                    warning.temperature_degC, config.limit_temperature_degC,
                    config.limit_temperature_degC - HeatWatch::kHysteresis_K));
  } else if (warning.hot) {
    add(
        fmt::format("{} degC, more than {:g} (warning_temperature_degC): let it cool, or the drive "
                    "will stop",
                    warning.temperature_degC, config.warning_temperature_degC));
  }
  if (warning.flagged) add("the drive warns (statusword, bit 7)");
  if (warning.emergency != 0) add(drive.link().emergency_text(warning.emergency));
  return line_about(drive, words.empty() ? "no warning any more" : words);
}

std::string ArmDrives::error_text(std::size_t joint, std::uint16_t status) const {
  const std::vector<Drive>& motors = joints_[joint].motors();
  const auto changed = std::ranges::find_if(motors, &Drive::setting_changed);
  const std::string reported = motors.front().link().status_text(status);
  if (enabling_ended_.load(std::memory_order_relaxed))
    return "did not enable in time (its state is " + reported + ")";
  if (changed == motors.end()) return reported;
  return changed->changed_setting() +
         ": changed past the bus while the drive was on; end what else writes to it, or "
         "find out why it restarted";
}

std::string ArmDrives::address_text(int joint) const {
  const auto of_motor = [](const ArmJoint& of) {
    const JointConfig& config = of.motors().front().link().joint();
    return fmt::format("{} ({})", config.name, config.drive.protocol->address(config.drive));
  };
  if (joint >= 0) return of_motor(joints_[static_cast<std::size_t>(joint)]);
  return joints_.size() == 1 ? of_motor(joints_.front())
                             : of_motor(joints_.front()) + " to " + of_motor(joints_.back());
}

std::string ArmDrives::heat_text(std::size_t joint, int temperature_degC) const {
  const JointConfig& config = joints_[joint].motors().front().link().joint();
  return fmt::format("{} degC, limit {:g} (limit_temperature_degC)", temperature_degC,
                     config.drive.limit_temperature_degC);
}

const Drive& ArmDrives::motor_at(int motor) const noexcept {
  std::size_t i = 0;
  while (motor >= static_cast<int>(joints_[i].motors().size()))
    motor -= static_cast<int>(joints_[i++].motors().size());
  return joints_[i].motors()[static_cast<std::size_t>(motor)];
}

// --- towards the drives --------------------------------------------------------------------------

void ArmDrives::add_bus_frames(std::vector<BusEnd>* buses) const {
  for (const ArmJoint& joint : joints_) {
    for (const Drive& motor : joint.motors()) {
      CanFrame frame;
      if (motor.link().needs_bus_frame(&frame)) (*buses)[motor.bus()].end_with(frame);
    }
  }
}

void ArmDrives::begin_cycle() noexcept {
  for (ArmJoint& joint : joints_) {
    for (Drive& motor : joint.motors()) motor.begin_cycle();
  }
}

void ArmDrives::add_commands(std::vector<BusEnd>* buses) noexcept {
  const bool settling = cycles_in_state_ < settling_cycles_;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    std::vector<Drive>& motors = joints_[i].motors();
    for (std::size_t m = 0; m < motors.size(); ++m) {
      const double tau = joints_[i].share(torque_[i], m);
      BusEnd& bus = (*buses)[motors[m].bus()];
      const CanFrame frame = motors[m].next_frame(machine_.state(), tau, settling);
      bus.add(frame);
      for (const CanFrame& request : motors[m].part_requests(machine_.state())) {
        if (!frame.remote || frame.id != request.id) bus.add(request);
      }
    }
  }
  ++cycles_in_state_;
  if (in(DriveState::kOn)) torque_present_ = torque_;
}

void ArmDrives::ask_for_settings(std::vector<BusEnd>* buses) noexcept {
  if (!in(DriveState::kOn) || cycles_in_state_ % kSettingCycles != 0) return;
  const std::int64_t round = cycles_in_state_ / kSettingCycles;
  std::array<int, kMaxBuses> number{};  // of the motor on its bus
  CanFrame request;
  for (ArmJoint& joint : joints_) {
    for (Drive& motor : joint.motors()) {
      const std::size_t bus = motor.bus();
      const bool its_turn = round % motors_on_bus_[bus] == number[bus]++;
      if (its_turn && motor.ask_for_setting(&request)) (*buses)[bus].ask(request);
    }
  }
}

// --- from the drives -----------------------------------------------------------------------------

std::vector<CanFilter> ArmDrives::receive_filters(std::size_t bus) const {
  std::vector<CanFilter> filters;
  for (const ArmJoint& joint : joints_) {
    for (const Drive& motor : joint.motors()) {
      if (motor.bus() != bus) continue;
      const std::vector<CanFilter> more = motor.link().receive_filters();
      filters.insert(filters.end(), more.begin(), more.end());
    }
  }
  return filters;
}

std::int64_t ArmDrives::silent_cycles(int joint) const noexcept {
  if (joint >= 0) return joints_[static_cast<std::size_t>(joint)].missing_cycles();
  return std::ranges::min_element(joints_, {}, &ArmJoint::silent_cycles)->silent_cycles();
}

Drive* ArmDrives::sender_of(std::size_t bus, const CanFrame& frame) noexcept {
  for (ArmJoint& joint : joints_) {
    for (Drive& motor : joint.motors()) {
      if (motor.bus() == bus && motor.link().is_mine(frame)) return &motor;
    }
  }
  return nullptr;
}

int ArmDrives::record_foreign(std::size_t bus, const CanFrame& frame) noexcept {
  int commanded = -1;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    for (Drive& motor : joints_[i].motors()) {
      if (motor.bus() != bus) continue;
      motor.record_foreign(frame);
      if (motor.link().is_foreign_command(frame)) commanded = static_cast<int>(i);
    }
  }
  return commanded;
}

bool ArmDrives::receive(std::size_t bus, const CanFrame& frame, bool late) noexcept {
  Drive* drive = sender_of(bus, frame);
  if (drive == nullptr) return false;
  if (late) {
    drive->receive_late(machine_.state(), frame);
  } else {
    drive->receive(machine_.state(), frame);
  }
  return true;
}

void ArmDrives::close_cycle(std::int64_t cycle, double time_s) noexcept {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    ArmJoint& joint = joints_[i];
    joint.close_cycle(machine_.state(), cycle, time_s);
    if (in(DriveState::kOn)) {
      rest_torque_[i].add(torque_[i].tau, joint.theta_dot());
    } else {
      rest_torque_[i].forget();
    }
  }
}

void ArmDrives::update_torque_present() noexcept {
  if (in(DriveState::kOn)) return;
  for (std::size_t i = 0; i < joints_.size(); ++i) torque_present_[i] = joints_[i].applied();
}

// --- an accepted command -------------------------------------------------------------------------

void ArmDrives::set_gravity(const joint_command_t& command) noexcept {
  std::copy_n(command.tau_gravity, kMaxJoints, tau_gravity_.begin());
}

void ArmDrives::follow(const joint_command_t& command) noexcept {
  execute(command.request);
  if (!in(DriveState::kOn)) return;
  for (std::size_t i = 0; i < joints_.size(); ++i)
    torque_[i] = {command.tau[i], command.tau_preload[i]};
}

void ArmDrives::execute(int request) noexcept {
  switch (request) {
    case joint_command_t::REQUEST_OFF:
      return apply(DriveEvent::kRequestOff);
    case joint_command_t::REQUEST_HOLD:
      return apply(DriveEvent::kRequestHold);
    case joint_command_t::REQUEST_ON:
      return turn_on(/*acknowledge=*/false);
    case joint_command_t::REQUEST_ACKNOWLEDGE:
      return turn_on(/*acknowledge=*/true);
    default:
      return;
  }
}

void ArmDrives::turn_on(bool acknowledged) noexcept {
  if (follows_torque() && std::ranges::all_of(joints_, &ArmJoint::healthy)) {
    apply(DriveEvent::kTakenOver);
  } else if (acknowledged) {
    acknowledge();
  } else if (std::ranges::all_of(joints_, &ArmJoint::ready_to_enable)) {
    apply(DriveEvent::kRequestOn);
  }
}

void ArmDrives::acknowledge() noexcept {
  if (machine_.holding() && !std::ranges::all_of(joints_, &ArmJoint::healthy)) return;
  for (ArmJoint& joint : joints_) joint.acknowledge();
  apply(DriveEvent::kAcknowledge);
}

// --- messages ------------------------------------------------------------------------------------

void ArmDrives::write_situation(GateSituation* situation) const noexcept {
  situation->powered = machine_.powered();
  situation->followed = follows_torque();
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    situation->torque_present[i] = torque_present_[i].tau;
    situation->preload_present[i] = torque_present_[i].preload;
  }
}

void ArmDrives::write_state(joint_state_t* state) const noexcept {
  state->drive_state = static_cast<std::int8_t>(machine_.state());
  state->fault = machine_.fault();
  state->fault_joint = machine_.fault_joint();
  for (std::size_t i = 0; i < joints_.size(); ++i) joints_[i].write_state(i, state);
  if (has_hand_) state->joint_flags[joints_.size() - 1] |= joint_state_t::JOINT_HAND;
}

void ArmDrives::write_status(driver_status_t* status) const noexcept {
  status->drive_state = static_cast<std::int8_t>(machine_.state());
  status->fault = machine_.fault();
  status->fault_joint = machine_.fault_joint();
  status->num_joints = static_cast<std::int8_t>(joints_.size());
  for (std::size_t i = 0; i < joints_.size(); ++i) joints_[i].write_status(i, status);
}

}  // namespace limber
