#include "drivers/drive_states.h"

#include <array>

namespace limber {
namespace {

// One letter a transition: Configuring, Off, Enabling, oN, Hold, Damp, Fault; '.' ignores the
// event.
struct Row {
  const char* next;  // by state, in the order of DriveState
  DriveEvent event;
  std::int8_t fault;
};

constexpr std::int8_t kNone = joint_state_t::FAULT_NONE;

// clang-format off
constexpr std::array<Row, kDriveEvents> kTable{{
    // CONFIGURING
    // |OFF
    // ||ENABLING
    // |||ON
    // ||||HOLD
    // |||||DAMP
    // ||||||FAULT
    {"O......", DriveEvent::kConfigured, kNone},
    {"..N....", DriveEvent::kEnabled, kNone},
    {"....NN.", DriveEvent::kTakenOver, kNone},
    {".E.....", DriveEvent::kRequestOn, kNone},
    {"..OOCC.", DriveEvent::kRequestOff, kNone},
    {"..OHHD.", DriveEvent::kRequestHold, joint_state_t::FAULT_REQUESTED},
    {"....HDC", DriveEvent::kAcknowledge, kNone},
    {"..ODDD.", DriveEvent::kShutDown, joint_state_t::FAULT_REQUESTED},
    {"F......", DriveEvent::kConfigurationWrong, joint_state_t::FAULT_CONFIGURATION},
    {"..F....", DriveEvent::kEnableTimedOut, joint_state_t::FAULT_DRIVE_ERROR},
    {"..FHHD.", DriveEvent::kControllerLost, joint_state_t::FAULT_CONTROLLER_LOST},
    {"..FH...", DriveEvent::kCommandRefused, joint_state_t::FAULT_COMMAND_REFUSED},
    {"..FHHD.", DriveEvent::kOverrun, joint_state_t::FAULT_OVERRUN},
    {"..FHHD.", DriveEvent::kHoldAsked, joint_state_t::FAULT_REQUESTED},
    {".FFHHD.", DriveEvent::kReplyLost, joint_state_t::FAULT_REPLY_LOST},
    {".FFFFF.", DriveEvent::kAllSilent, joint_state_t::FAULT_REPLY_LOST},
    {"FFFHHD.", DriveEvent::kBusLost, joint_state_t::FAULT_BUS},
    {"..FHHD.", DriveEvent::kDriveError, joint_state_t::FAULT_DRIVE_ERROR},
    {"..FHHD.", DriveEvent::kPositionTrip, joint_state_t::FAULT_POSITION},
    {"..FDDD.", DriveEvent::kVelocityTrip, joint_state_t::FAULT_VELOCITY},
}};
// clang-format on

constexpr const Row& row_of(DriveEvent event) noexcept {
  return kTable[static_cast<std::size_t>(event)];
}

constexpr bool rows_are_in_order() {
  for (int i = 0; i < kDriveEvents; ++i) {
    if (row_of(static_cast<DriveEvent>(i)).event != static_cast<DriveEvent>(i)) return false;
  }
  return true;
}
static_assert(rows_are_in_order());

}  // namespace

DriveTransition drive_transition(DriveState state, DriveEvent event) noexcept {
  switch (row_of(event).next[static_cast<int>(state)]) {
    case 'C':
      return {false, DriveState::kConfiguring};
    case 'O':
      return {false, DriveState::kOff};
    case 'E':
      return {false, DriveState::kEnabling};
    case 'N':
      return {false, DriveState::kOn};
    case 'H':
      return {false, DriveState::kHold};
    case 'D':
      return {false, DriveState::kDamp};
    case 'F':
      return {false, DriveState::kFault};
    default:
      return {};
  }
}

std::int8_t fault_of(DriveEvent event) noexcept { return row_of(event).fault; }

bool DriveStateMachine::apply(DriveEvent event, int joint) noexcept {
  const DriveTransition transition = drive_transition(state_, event);
  if (transition.ignored) return false;
  const bool changed = transition.next != state_;
  state_ = transition.next;
  const bool latches =
      state_ == DriveState::kHold || state_ == DriveState::kDamp || state_ == DriveState::kFault;
  if (event == DriveEvent::kAcknowledge || !latches) {
    fault_ = joint_state_t::FAULT_NONE;
    fault_joint_ = -1;
    acknowledged_ = latches;
  } else {
    acknowledged_ = false;
    if (fault_ == joint_state_t::FAULT_NONE) {
      fault_ = fault_of(event);
      fault_joint_ = static_cast<std::int8_t>(joint);
    }
  }
  return changed;
}

bool DriveStateMachine::powered() const noexcept {
  return state_ == DriveState::kEnabling || state_ == DriveState::kOn ||
         state_ == DriveState::kHold || state_ == DriveState::kDamp;
}

}  // namespace limber
