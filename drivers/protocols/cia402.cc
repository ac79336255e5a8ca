#include "drivers/protocols/cia402.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace limber::cia402 {
namespace {

/// Statusword of a state: statusword & mask == value.
struct StatePattern {
  State state;
  std::uint16_t mask;
  std::uint16_t value;
  const char* name;
};
constexpr std::array<StatePattern, kStates> kPatterns = {{
    {State::kNotReady, 0x4F, 0x00, "not ready to switch on"},
    {State::kSwitchOnDisabled, 0x4F, 0x40, "switch on disabled"},
    {State::kReadyToSwitchOn, 0x6F, 0x21, "ready to switch on"},
    {State::kSwitchedOn, 0x6F, 0x23, "switched on"},
    {State::kOperationEnabled, 0x6F, 0x27, "operation enabled"},
    {State::kQuickStopActive, 0x6F, 0x07, "quick stop active"},
    {State::kFaultReactionActive, 0x4F, 0x0F, "fault reaction active"},
    {State::kFault, 0x4F, 0x08, "fault"},
}};

/// Controlword of a command.
struct CommandPattern {
  Command command;
  std::uint16_t mask;
  std::uint16_t value;
};
constexpr std::array kCommandPatterns = {
    CommandPattern{Command::kDisableVoltage, 0x02, 0x00},
    CommandPattern{Command::kQuickStop, 0x06, 0x02},
    CommandPattern{Command::kShutdown, 0x07, 0x06},
    CommandPattern{Command::kSwitchOn, 0x0F, 0x07},
    CommandPattern{Command::kEnableOperation, 0x0F, 0x0F},
};

/// The transitions that commands make (CiA 402-2, numbers of its state diagram).
struct Transition {
  int number;
  State from;
  Command command;
  State to;
};
constexpr std::array kTransitions = {
    Transition{2, State::kSwitchOnDisabled, Command::kShutdown, State::kReadyToSwitchOn},
    Transition{3, State::kReadyToSwitchOn, Command::kSwitchOn, State::kSwitchedOn},
    // On enable operation a drive passes through switched on by itself.
    Transition{3, State::kReadyToSwitchOn, Command::kEnableOperation, State::kOperationEnabled},
    Transition{4, State::kSwitchedOn, Command::kEnableOperation, State::kOperationEnabled},
    Transition{5, State::kOperationEnabled, Command::kSwitchOn, State::kSwitchedOn},
    Transition{6, State::kSwitchedOn, Command::kShutdown, State::kReadyToSwitchOn},
    Transition{7, State::kReadyToSwitchOn, Command::kDisableVoltage, State::kSwitchOnDisabled},
    Transition{7, State::kReadyToSwitchOn, Command::kQuickStop, State::kSwitchOnDisabled},
    Transition{8, State::kOperationEnabled, Command::kShutdown, State::kReadyToSwitchOn},
    Transition{9, State::kOperationEnabled, Command::kDisableVoltage, State::kSwitchOnDisabled},
    Transition{10, State::kSwitchedOn, Command::kDisableVoltage, State::kSwitchOnDisabled},
    Transition{10, State::kSwitchedOn, Command::kQuickStop, State::kSwitchOnDisabled},
    Transition{11, State::kOperationEnabled, Command::kQuickStop, State::kQuickStopActive},
    Transition{12, State::kQuickStopActive, Command::kDisableVoltage, State::kSwitchOnDisabled},
    Transition{15, State::kFault, Command::kFaultReset, State::kSwitchOnDisabled},
    Transition{16, State::kQuickStopActive, Command::kEnableOperation, State::kOperationEnabled},
};
constexpr int kAfterQuickStop = 16;

}  // namespace

State state_of(std::uint16_t statusword) noexcept {
  for (const StatePattern& pattern : kPatterns) {
    if ((statusword & pattern.mask) == pattern.value) return pattern.state;
  }
  return State::kNotReady;
}

std::uint16_t statusword_of(State state) noexcept {
  return kPatterns[static_cast<std::size_t>(state)].value;
}

const char* name_of(State state) noexcept {
  return kPatterns[static_cast<std::size_t>(state)].name;
}

Command command_of(std::uint16_t controlword, std::uint16_t previous) noexcept {
  if ((controlword & kFaultReset) != 0)
    return (previous & kFaultReset) == 0 ? Command::kFaultReset : Command::kNone;
  for (const CommandPattern& pattern : kCommandPatterns) {
    if ((controlword & pattern.mask) == pattern.value) return pattern.command;
  }
  return Command::kNone;
}

State next_state(State state, Command command, bool enable_after_quick_stop) noexcept {
  for (const Transition& transition : kTransitions) {
    if (transition.from != state || transition.command != command) continue;
    return transition.number == kAfterQuickStop && !enable_after_quick_stop ? state : transition.to;
  }
  return state;
}

std::uint16_t towards_enabled(State state) noexcept {
  switch (state) {
    case State::kReadyToSwitchOn:
      return kSwitchOn;
    case State::kSwitchedOn:
    case State::kOperationEnabled:
      return kEnableOperation;
    case State::kQuickStopActive:
    case State::kFaultReactionActive:
    case State::kFault:
      return kDisableVoltage;
    case State::kNotReady:
    case State::kSwitchOnDisabled:
      break;
  }
  return kShutdown;
}

std::int16_t to_permille(double value, double rated) noexcept {
  const double permille = std::nearbyint(1000.0 * value / rated);
  if (std::isnan(permille)) return 0;
  return static_cast<std::int16_t>(std::clamp(permille, -32767.0, 32767.0));
}

double from_permille(std::int16_t permille, double rated) noexcept {
  return static_cast<double>(permille) * rated / 1000.0;
}

}  // namespace limber::cia402
