// What the driver tells others: JOINT_STATE, DRIVER_STATUS, and why a drive was refused.
#include <fmt/format.h>

#include <algorithm>

#include "drivers/arm_driver_impl.h"

namespace limber {

void ArmDriver::Impl::describe_state() noexcept {
  published.seq = cycle;
  published.time_ns = time_ns;
  published.drive_state = static_cast<std::int8_t>(state());
  published.fault = machine.fault();
  published.fault_joint = machine.fault_joint();
  for (std::size_t i = 0; i < joints.size(); ++i) describe_joint(i);
  if (tip_sensor) describe_tip_sensor();
  // The step to the first torque after HOLD or DAMP counts from what the drives themselves exert.
  if (in(DriveState::kOn)) return;
  for (std::size_t i = 0; i < joints.size(); ++i) torque_present[i] = joints[i].applied();
}

void ArmDriver::Impl::describe_joint(std::size_t i) noexcept {
  const ArmJoint& joint = joints[i];
  published.q[i] = joint.q();
  published.v[i] = joint.v();
  published.theta[i] = joint.theta();
  published.theta_dot[i] = joint.theta_dot();
  published.preload[i] = static_cast<float>(joint.preload());
  published.preload_dot[i] = static_cast<float>(joint.preload_dot());
  published.tau[i] = joint.tau();
  published.tau_applied[i] = joint.applied().tau;
  published.current_A[i] = static_cast<float>(joint.current_A());
  published.temperature_degC[i] = static_cast<float>(joint.temperature_degC());
  published.age_cycles[i] = joint.age_cycles();
  published.joint_flags[i] = joint.flags();
}

void ArmDriver::Impl::describe_tip_sensor() noexcept {
  std::copy_n(tip_sensor->reading().F.begin(), 6, published.F_sensor);
  published.sensor_age_cycles = tip_sensor->age_cycles();
  published.sensor_state = tip_sensor->state();
}

void ArmDriver::fill_status(driver_status_t* status) const noexcept {
  const Impl& driver = *impl_;
  status->time_ns = driver.time_ns;
  status->session = driver.session;
  status->drive_state = static_cast<std::int8_t>(driver.state());
  status->fault = driver.machine.fault();
  status->fault_joint = driver.machine.fault_joint();
  status->num_joints = static_cast<std::int8_t>(driver.joints.size());
  status->num_buses = static_cast<std::int8_t>(driver.buses.size());
  status->lockstep = driver.lockstep ? 1 : 0;
  status->cycles = driver.cycle + 1;
  status->commands_accepted = driver.verdicts[driver_status_t::VERDICT_ACCEPTED];
  std::copy(driver.verdicts.begin(), driver.verdicts.end(), status->commands_refused);
  status->commands_refused[driver_status_t::VERDICT_ACCEPTED] = 0;
  status->commands_missing = driver.missing;
  for (std::size_t i = 0; i < driver.joints.size(); ++i) {
    status->replies_late[i] = driver.joints[i].replies_late();
    status->replies_lost[i] = driver.joints[i].replies_lost();
    status->replies_invalid[i] = driver.joints[i].replies_invalid();
  }
  if (driver.tip_sensor) {
    status->sensor_replies_late = driver.tip_sensor->late();
    status->sensor_replies_lost = driver.tip_sensor->lost();
    status->sensor_replies_invalid = driver.tip_sensor->invalid();
  }
  for (std::size_t b = 0; b < driver.buses.size(); ++b) {
    const BusEnd& bus = driver.buses[b];
    status->bus_load_predicted[b] = static_cast<float>(driver.load_predicted[b]);
    status->bus_load_counted[b] = static_cast<float>(bus.load_counted());
    status->frames_sent[b] = bus.statistics().sent;
    status->frames_received[b] = bus.statistics().received;
    status->frames_foreign[b] = bus.foreign();
    status->send_refused[b] = bus.statistics().send_refused;
    status->error_frames[b] = bus.statistics().error_frames;
  }
}

std::string ArmDriver::configuration_problem() const {
  for (const ArmJoint& joint : impl_->joints) {
    for (const Drive& motor : joint.motors()) {
      if (!motor.configuration_wrong()) continue;
      const JointConfig& config = motor.link().joint();
      return fmt::format("{} (id 0x{:X}): {}", config.name, config.drive.command_id,
                         motor.configuration_problem());
    }
  }
  return "";
}

}  // namespace limber
