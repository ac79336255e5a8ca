// What the three processes log, out of a lab; see ArmPort, StateReporter and ControllerProcess.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "controller/controller_log.h"
#include "lab/lab.h"

namespace limber {

class Told {
 public:
  /// `black_box`: where the last seconds are kept at a fault; may be null.
  explicit Told(const Robot& robot, BlackBox* black_box = nullptr);

  /// After a cycle and its messages. Allocates where something is logged.
  void note(Lab& lab);

 private:
  void note_drives(Lab& lab);

  std::vector<std::string> joints_;
  BlackBox* black_box_;
  ControllerLog controller_;
  std::int8_t fault_ = joint_state_t::FAULT_NONE;
};

}  // namespace limber
