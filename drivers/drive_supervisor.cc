#include "drivers/drive_supervisor.h"

#include <algorithm>

#include "drivers/driver_setup.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

constexpr int kEnablingCycles = 20;
constexpr int kSilentCycles = 3;

/// As long as the slowest of them may take.
double enabling_s(const Robot& robot) {
  double longest_s = 0.0;
  for (const JointConfig& joint : robot.driven())
    longest_s = std::max(longest_s, joint.drive.protocol->enabling_s);
  return longest_s;
}

}  // namespace

DriveSupervisor::DriveSupervisor(const Robot& robot)
    : enabling_cycles_(std::max(cycles_of(enabling_s(robot), robot.rate_hz), kEnablingCycles)),
      drive_watchdog_cycles_(drive_watchdog_cycles_of(robot)) {}

void DriveSupervisor::check(std::span<const BusEnd> buses, ArmDrives* drives) const noexcept {
  if (drives->in(DriveState::kConfiguring)) {
    check_configuration(drives);
  } else if (drives->in(DriveState::kEnabling)) {
    check_enabling(drives);
  }
  if (std::ranges::any_of(buses, &BusEnd::lost)) drives->apply(DriveEvent::kBusLost);
  check_replies(drives);
  check_motion(drives);
}

void DriveSupervisor::check_configuration(ArmDrives* drives) const noexcept {
  const std::vector<ArmJoint>& joints = drives->joints();
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i].configuration_wrong())
      drives->apply(DriveEvent::kConfigurationWrong, static_cast<int>(i));
  }
  if (std::ranges::all_of(joints, &ArmJoint::configured)) drives->apply(DriveEvent::kConfigured);
}

void DriveSupervisor::check_enabling(ArmDrives* drives) const noexcept {
  const std::vector<ArmJoint>& joints = drives->joints();
  const auto waiting = std::ranges::find_if_not(joints, &ArmJoint::enabling_done);
  if (waiting == joints.end()) {
    drives->apply(DriveEvent::kEnabled);
  } else if (drives->cycles_in_state() >= enabling_cycles_) {
    drives->apply(DriveEvent::kEnableTimedOut, static_cast<int>(waiting - joints.begin()));
  }
}

void DriveSupervisor::check_replies(ArmDrives* drives) const noexcept {
  const std::vector<ArmJoint>& joints = drives->joints();
  const std::int64_t silence =
      std::ranges::min_element(joints, {}, &ArmJoint::silent_cycles)->silent_cycles();
  // Late is not off: drives that may still receive are commanded to hold. After a silence as long
  // as their own watchdogs wait, these have acted, and nothing is left that could be commanded.
  const bool all_silent = silence >= kSilentCycles;
  if (all_silent && silence >= drive_watchdog_cycles_) drives->apply(DriveEvent::kAllSilent);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i].often_invalid()) drives->apply(DriveEvent::kReplyInvalid, static_cast<int>(i));
    if (joints[i].lost())
      drives->apply(DriveEvent::kReplyLost, all_silent ? -1 : static_cast<int>(i));
  }
}

void DriveSupervisor::check_motion(ArmDrives* drives) const noexcept {
  if (!drives->in(DriveState::kOn) && !drives->in(DriveState::kFallback) &&
      !drives->in(DriveState::kDamp))
    return;
  const std::vector<ArmJoint>& joints = drives->joints();
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const int joint = static_cast<int>(i);
    if (!joints[i].enabled() || joints[i].ignores_target() || joints[i].setting_changed())
      drives->apply(DriveEvent::kDriveError, joint);
    if (joints[i].contradiction() != Contradiction::kNone)
      drives->apply(DriveEvent::kFeedbackWrong, joint);
    if (joints[i].too_hot()) drives->apply(DriveEvent::kTooHot, joint);
    if (joints[i].out_of_range()) drives->apply(DriveEvent::kPositionTrip, joint);
    if (joints[i].too_fast()) drives->apply(DriveEvent::kVelocityTrip, joint);
  }
  // Their power failed, or their watchdogs acted: no drive is left that could hold or brake.
  if (drives->all_disabled()) drives->apply(DriveEvent::kAllSilent);
}

}  // namespace limber
