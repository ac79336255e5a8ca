#include "drivers/arm_driver.h"

#include <algorithm>
#include <cmath>

#include "drivers/arm_driver_impl.h"
#include "drivers/driver_setup.h"

namespace limber {
namespace {

constexpr double kSettling_s = 0.1;  // HOLD: damping before the position is held
constexpr double kShutDownBraking_s = 0.3;
constexpr int kFramesPerPoll = 16;  // batches: a flooded bus must not keep the cycle

}  // namespace

ArmDriver::Impl::Impl(const Robot& robot, const std::vector<CanBus*>& can,
                      const ArmDriverOptions& options)
    : rate_hz(robot.rate_hz),
      drive_watchdog_cycles(drive_watchdog_cycles_of(robot)),
      lockstep(options.lockstep),
      bridged_cycles(options.bridged_cycles),
      session(options.session),
      gate(gate_limits(robot, options.session)) {
  for (std::size_t b = 0; b < can.size(); ++b) {
    buses.emplace_back(can[b], robot.buses[b]);
    load_predicted.push_back(checked_bus_load(robot, static_cast<int>(b)));
  }
  for (const JointConfig& joint : robot.joints) joints.emplace_back(robot, joint, bridged_cycles);
  for (const ArmJoint& joint : joints) {
    for (const Drive& motor : joint.motors()) {
      CanFrame frame;
      if (motor.link().needs_bus_frame(&frame))
        buses[static_cast<std::size_t>(motor.bus())].end_with(frame);
    }
  }
  if (robot.has_tip_sensor) tip_sensor.emplace(robot.tip_sensor, bridged_cycles);
  published.session = session;
  published.period_ns = std::llround(1e9 / rate_hz);
  published.num_joints = static_cast<std::int8_t>(joints.size());
}

ArmDriver::ArmDriver(const Robot& robot, std::vector<CanBus*> buses,
                     const ArmDriverOptions& options) {
  check_robot(robot, buses.size(), options.session);
  impl_ = std::make_unique<Impl>(robot, buses, options);
}

ArmDriver::~ArmDriver() = default;

void ArmDriver::Impl::apply(DriveEvent event, int joint) noexcept {
  const DriveState from = state();
  if (!machine.apply(event, joint)) return;
  cycles_in_state = 0;
  for (std::size_t i = 0; i < joints.size(); ++i)
    joints[i].enter(state(), {tau_gravity[i], torque[i].preload});
  if (in(DriveState::kOn) && from == DriveState::kEnabling) {
    torque.fill({});
    torque_present.fill({});
  }
}

// --- 1. transmit ---------------------------------------------------------------------------------

void ArmDriver::transmit(std::int64_t time_ns) noexcept {
  impl_->take_frames(/*late=*/true);
  ++impl_->cycle;
  impl_->time_ns = time_ns;
  impl_->gate.next_cycle();
  impl_->watch_controller();
  impl_->watch_shut_down();
  impl_->send_commands();
}

void ArmDriver::Impl::watch_controller() noexcept {
  unheard_cycles = heard ? 0 : unheard_cycles + 1;
  if (!heard && gate.memory().controller != 0) ++missing;
  heard = false;
  if (unheard_cycles > bridged_cycles) apply(DriveEvent::kControllerLost);
}

void ArmDriver::Impl::watch_shut_down() noexcept {
  if (!shutting_down) return;
  apply(DriveEvent::kShutDown);
  if (cycles_in_state >= cycles_of(kShutDownBraking_s, rate_hz)) apply(DriveEvent::kRequestOff);
}

void ArmDriver::Impl::send_commands() noexcept {
  const bool settling = cycles_in_state < cycles_of(kSettling_s, rate_hz);
  for (BusEnd& bus : buses) bus.clear();
  for (std::size_t i = 0; i < joints.size(); ++i) {
    std::vector<Drive>& motors = joints[i].motors();
    for (std::size_t m = 0; m < motors.size(); ++m) {
      const double tau = joints[i].share(torque[i], m);
      buses[static_cast<std::size_t>(motors[m].bus())].add(
          motors[m].next_frame(state(), tau, settling));
      motors[m].begin_cycle();
    }
  }
  if (tip_sensor) {
    buses[static_cast<std::size_t>(tip_sensor->bus())].add(tip_sensor->next_frame());
    tip_sensor->begin_cycle();
  }
  ++cycles_in_state;
  if (in(DriveState::kOn)) torque_present = torque;
  for (BusEnd& bus : buses) {
    bus.send();
    bus.expect_tock(cycle);
    if (lockstep) bus.send_tick();
  }
}

void ArmDriver::repeat_tick() noexcept {
  for (BusEnd& bus : impl_->buses) {
    if (!bus.tocked()) bus.send_tick();
  }
}

// --- 2. poll -------------------------------------------------------------------------------------

void ArmDriver::poll() noexcept { impl_->take_frames(/*late=*/false); }

void ArmDriver::Impl::take_frames(bool late) noexcept {
  for (std::size_t b = 0; b < buses.size(); ++b) {
    for (int batch = 0; batch < kFramesPerPoll; ++batch) {
      const std::span<const CanFrame> frames = buses[b].receive();
      for (const CanFrame& frame : frames) take_frame(static_cast<int>(b), frame, late);
      if (frames.empty()) break;
    }
  }
}

void ArmDriver::Impl::take_frame(int bus, const CanFrame& frame, bool late) noexcept {
  BusEnd& end = buses[static_cast<std::size_t>(bus)];
  if (frame.error || end.take_lockstep(frame)) return;
  if (tip_sensor && tip_sensor->is_mine(bus, frame)) {
    tip_sensor->receive(frame, late);
    return;
  }
  Drive* drive = sender_of(bus, frame);
  if (drive == nullptr) {
    end.count_foreign();
  } else if (late) {
    drive->receive_late(state(), frame);
  } else {
    drive->receive(state(), frame);
  }
}

Drive* ArmDriver::Impl::sender_of(int bus, const CanFrame& frame) noexcept {
  for (ArmJoint& joint : joints) {
    for (Drive& motor : joint.motors()) {
      if (motor.bus() == bus && motor.link().is_mine(frame)) return &motor;
    }
  }
  return nullptr;
}

bool ArmDriver::complete() const noexcept {
  if (impl_->lockstep) {
    return std::all_of(impl_->buses.begin(), impl_->buses.end(),
                       [](const BusEnd& bus) { return bus.tocked(); });
  }
  return impl_->all_joints(&ArmJoint::answered) &&
         (!impl_->tip_sensor || impl_->tip_sensor->settled());
}

// --- 3. finish_cycle -----------------------------------------------------------------------------

const joint_state_t& ArmDriver::finish_cycle() noexcept {
  impl_->supervise();
  impl_->describe_state();
  return impl_->published;
}

// --- 4. accept -----------------------------------------------------------------------------------

int ArmDriver::accept(const joint_torque_t& command) noexcept {
  Impl& driver = *impl_;
  const GateSituation situation = driver.situation();
  const int verdict = driver.gate.judge(command, situation);
  ++driver.verdicts[static_cast<std::size_t>(verdict)];
  if (verdict == driver_status_t::VERDICT_ACCEPTED) {
    driver.obey(command, situation.followed);
  } else if (driver.gate.refused_too_often()) {
    driver.apply(DriveEvent::kCommandRefused);
  }
  return verdict;
}

GateSituation ArmDriver::Impl::situation() const noexcept {
  const bool held = in(DriveState::kHold) || in(DriveState::kDamp);
  GateSituation now;
  now.state_seq = cycle;
  now.powered = machine.powered();
  now.followed = in(DriveState::kOn) || (held && machine.acknowledged());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    now.torque_present[i] = torque_present[i].tau;
    now.preload_present[i] = torque_present[i].preload;
  }
  std::copy_n(published.v, kMaxJoints, now.velocity.begin());
  return now;
}

void ArmDriver::Impl::obey(const joint_torque_t& command, bool followed) noexcept {
  heard = true;
  std::copy_n(command.tau_gravity, kMaxJoints, tau_gravity.begin());
  if (shutting_down) return;
  switch (command.request) {
    case joint_torque_t::REQUEST_OFF:
      apply(DriveEvent::kRequestOff);
      break;
    case joint_torque_t::REQUEST_HOLD:
      apply(DriveEvent::kRequestHold);
      break;
    case joint_torque_t::REQUEST_ON:
    case joint_torque_t::REQUEST_ACKNOWLEDGE:
      if (followed && all_joints(&ArmJoint::healthy)) {
        apply(DriveEvent::kTakenOver);
      } else if (command.request == joint_torque_t::REQUEST_ACKNOWLEDGE) {
        acknowledge();
      } else if (all_joints(&ArmJoint::ready_to_enable)) {
        apply(DriveEvent::kRequestOn);
      }
      break;
    default:
      break;
  }
  if (!in(DriveState::kOn)) return;
  for (std::size_t i = 0; i < joints.size(); ++i)
    torque[i] = {command.tau[i], command.tau_preload[i]};
}

void ArmDriver::Impl::acknowledge() noexcept {
  const bool held = in(DriveState::kHold) || in(DriveState::kDamp);
  if (held && !all_joints(&ArmJoint::healthy)) return;
  for (ArmJoint& joint : joints) joint.acknowledge();
  apply(DriveEvent::kAcknowledge);
}

// --- requests from outside -----------------------------------------------------------------------

void ArmDriver::request_hold(int fault) noexcept {
  impl_->apply(fault == joint_state_t::FAULT_OVERRUN ? DriveEvent::kOverrun
                                                     : DriveEvent::kHoldAsked);
}

void ArmDriver::request_shut_down() noexcept { impl_->shutting_down = true; }

bool ArmDriver::shut_down() const noexcept {
  return impl_->shutting_down && (impl_->in(DriveState::kOff) || impl_->in(DriveState::kFault)) &&
         impl_->all_joints(&ArmJoint::disabled);
}

}  // namespace limber
