#include "drivers/drive/drive_state_machine.h"

namespace limber {

bool DriveStateMachine::apply(DriveEvent event, int joint) noexcept {
  const DriveTransition* transition = find_drive_transition(state_, event);
  if (transition == nullptr) return false;
  state_ = transition->to;
  const bool latches = holding() || state_ == DriveState::kFault;
  if (event == DriveEvent::kAcknowledge || !latches) {
    fault_ = joint_state_t::FAULT_NONE;
    fault_joint_ = -1;
    acknowledged_ = latches;
  } else {
    acknowledged_ = false;
    if (fault_ == joint_state_t::FAULT_NONE) {
      fault_ = transition->fault;
      fault_joint_ = static_cast<std::int8_t>(joint);
    }
  }
  return state_ != transition->from;
}

}  // namespace limber
