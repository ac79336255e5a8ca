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

}  // namespace

void ArmDriver::Impl::supervise() noexcept {
  for (Drive& drive : drives) drive.close_cycle(state(), cycle);
  supervise_progress();
  supervise_replies();
  supervise_motion();
  if ((cycle + 1) % channels::kDriverStatusEvery == 0) {
    for (BusEnd& bus : buses) bus.close_interval(channels::kDriverStatusEvery / rate_hz);
  }
}

void ArmDriver::Impl::supervise_progress() noexcept {
  if (in(DriveState::kConfiguring)) {
    for (std::size_t i = 0; i < drives.size(); ++i) {
      if (drives[i].configuration_wrong())
        apply(DriveEvent::kConfigurationWrong, static_cast<int>(i));
    }
    if (all_drives(&Drive::configured)) apply(DriveEvent::kConfigured);
  } else if (in(DriveState::kEnabling)) {
    const int patience = std::max(cycles_of(kEnabling_s, rate_hz), kEnablingCycles);
    const auto waiting = std::find_if(drives.begin(), drives.end(),
                                      [](const Drive& drive) { return !drive.enabling_done(); });
    if (waiting == drives.end()) {
      apply(DriveEvent::kEnabled);
    } else if (cycles_in_state >= patience) {
      apply(DriveEvent::kEnableTimedOut, static_cast<int>(waiting - drives.begin()));
    }
  }
}

void ArmDriver::Impl::supervise_replies() noexcept {
  for (const BusEnd& bus : buses) {
    if (bus.lost()) apply(DriveEvent::kBusLost);
  }
  if (in(DriveState::kConfiguring)) return;
  if (all_drives(&Drive::silent)) apply(DriveEvent::kAllSilent);
  for (std::size_t i = 0; i < drives.size(); ++i) {
    if (drives[i].lost()) apply(DriveEvent::kReplyLost, static_cast<int>(i));
  }
}

void ArmDriver::Impl::supervise_motion() noexcept {
  if (!in(DriveState::kOn) && !in(DriveState::kHold) && !in(DriveState::kDamp)) return;
  for (std::size_t i = 0; i < drives.size(); ++i) {
    const int joint = static_cast<int>(i);
    if (!drives[i].link().enabled()) apply(DriveEvent::kDriveError, joint);
    if (drives[i].link().out_of_range()) apply(DriveEvent::kPositionTrip, joint);
    if (drives[i].too_fast()) apply(DriveEvent::kVelocityTrip, joint);
  }
}

}  // namespace limber
