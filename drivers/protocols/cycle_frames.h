// The frames that one cycle puts on a bus: known from robot.yaml by identifier and length, before
// any is sent. For predictions of load and time.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "drivers/can/can_frame.h"
#include "robots/loader/robot.h"

#pragma GCC visibility push(default)
namespace limber {

/// While the drives are on, one drive of each bus is asked for a setting every so many cycles.
inline constexpr int kSettingCycles = 20;

/// One drive, or the tip sensor. The data of the frames are zero.
struct Exchange {
  std::string name;  ///< of the joint, or "tip sensor"
  CanFrame command;
  std::vector<CanFrame> replies;
  bool at_sync = false;           ///< answers the SYNC at the end of all commands, not its command
  std::vector<CanFrame> setting;  ///< request and answer, where the protocol has them
  /// Remote frames behind the command, one for each reply; none: the command asks for them.
  std::vector<CanFrame> requests = {};
};

/// In the order in which the driver sends the commands. Set-up only.
std::vector<Exchange> cycle_frames(const Robot& robot, int bus);

/// Data in which one byte of three is zero and the others random, as high bytes of small numbers
/// are.
void fill_typical(CanFrame* frame, std::minstd_rand* random) noexcept;

}  // namespace limber
#pragma GCC visibility pop
