// The driver's judgement at the end of each cycle: what the replies mean for the state of the
// drives.
#include <algorithm>
#include <cmath>

#include "drivers/arm_driver_impl.h"
#include "drivers/driver_setup.h"
#include "lcmtypes/channels.h"

namespace limber {
namespace {

constexpr double kEnabling_s = 0.1;  // at least kEnablingCycles
constexpr int kEnablingCycles = 20;
constexpr int kSilentCycles = 3;

}  // namespace

void ArmDriver::Impl::supervise() noexcept {
  for (ArmJoint& joint : joints) joint.close_cycle(state(), cycle);
  if (tip_sensor) tip_sensor->close_cycle();
  supervise_progress();
  supervise_replies();
  supervise_motion();
  if ((cycle + 1) % channels::kDriverStatusEvery == 0) {
    for (BusEnd& bus : buses) bus.close_interval(channels::kDriverStatusEvery / rate_hz);
  }
}

void ArmDriver::Impl::supervise_progress() noexcept {
  if (in(DriveState::kConfiguring)) {
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (joints[i].configuration_wrong())
        apply(DriveEvent::kConfigurationWrong, static_cast<int>(i));
    }
    if (all_joints(&ArmJoint::configured)) apply(DriveEvent::kConfigured);
  } else if (in(DriveState::kEnabling)) {
    const int patience = std::max(cycles_of(kEnabling_s, rate_hz), kEnablingCycles);
    const auto waiting = std::find_if(joints.begin(), joints.end(),
                                      [](const ArmJoint& joint) { return !joint.enabling_done(); });
    if (waiting == joints.end()) {
      apply(DriveEvent::kEnabled);
    } else if (cycles_in_state >= patience) {
      apply(DriveEvent::kEnableTimedOut, static_cast<int>(waiting - joints.begin()));
    }
  }
}

void ArmDriver::Impl::supervise_replies() noexcept {
  for (const BusEnd& bus : buses) {
    if (bus.lost()) apply(DriveEvent::kBusLost);
  }
  if (in(DriveState::kConfiguring)) return;
  // Late is not off: as long as the drives may still hear, they are told to hold. Once they have
  // heard nobody for so long that their own watchdogs have acted, the arm is not ours any more.
  const std::int64_t silence = cycles_all_silent();
  if (silence >= kSilentCycles && silence >= drive_watchdog_cycles) apply(DriveEvent::kAllSilent);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const int who = silence >= kSilentCycles ? -1 : static_cast<int>(i);
    if (joints[i].lost()) apply(DriveEvent::kReplyLost, who);
  }
}

std::int64_t ArmDriver::Impl::cycles_all_silent() const noexcept {
  const auto first_to_speak = std::min_element(
      joints.begin(), joints.end(),
      [](const ArmJoint& a, const ArmJoint& b) { return a.silent_cycles() < b.silent_cycles(); });
  return first_to_speak->silent_cycles();
}

void ArmDriver::Impl::supervise_motion() noexcept {
  if (!in(DriveState::kOn) && !in(DriveState::kHold) && !in(DriveState::kDamp)) return;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const int joint = static_cast<int>(i);
    if (!joints[i].enabled()) apply(DriveEvent::kDriveError, joint);
    if (joints[i].out_of_range()) apply(DriveEvent::kPositionTrip, joint);
    if (joints[i].too_fast()) apply(DriveEvent::kVelocityTrip, joint);
  }
  // The drives' power failed, or their watchdogs acted: there is nothing left that could hold or
  // brake.
  if (all_joints(&ArmJoint::disabled)) apply(DriveEvent::kAllSilent);
}

}  // namespace limber
