// The checks at the end of each cycle: which event the replies of drives and buses amount to.
//
//   progress   start-up dialogues done or failed; every drive enabled, or not in time
//   replies    a bus lost; a joint silent; all joints silent for as long as their own watchdogs
//   motion     a drive left the enabled state, ignores its target or has other settings; what it
//              reports contradicts itself; position or velocity beyond its limit
#pragma once

#include <span>

#include "drivers/arm_drives.h"
#include "drivers/drive/bus_end.h"
#include "robots/loader/robot.h"

namespace limber {

class DriveSupervisor {
 public:
  explicit DriveSupervisor(const Robot& robot);

  /// Applies the events of a cycle that is closed. Allowed in the cycle.
  void check(std::span<const BusEnd> buses, ArmDrives* drives) const noexcept;

 private:
  void check_configuration(ArmDrives* drives) const noexcept;
  void check_enabling(ArmDrives* drives) const noexcept;
  void check_replies(ArmDrives* drives) const noexcept;
  void check_motion(ArmDrives* drives) const noexcept;

  int enabling_cycles_;        ///< most that enabling may take
  int drive_watchdog_cycles_;  ///< of the slowest drive
};

}  // namespace limber
