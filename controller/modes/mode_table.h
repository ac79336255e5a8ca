// The controller's modes and what makes them change: one table, nothing else decides.
#pragma once

#include <array>
#include <cstdint>
#include <limber/controller_status_t.hpp>
#include <span>

#include "controller/kinds/activity.h"

namespace limber::controller {

/// Numbers of controller_status_t.
enum class Mode : std::int8_t {
  kBoot = controller_status_t::MODE_BOOT,           ///< no state yet
  kInit = controller_status_t::MODE_INIT,           ///< waiting for a steady stream of good states
  kIdle = controller_status_t::MODE_IDLE,           ///< no torque
  kHold = controller_status_t::MODE_HOLD,           ///< soft at the place where it was asked for
  kActive = controller_status_t::MODE_ACTIVE,       ///< the selected law follows its goal
  kSoftStop = controller_status_t::MODE_SOFT_STOP,  ///< the goal comes to rest, then HOLD
  kFault = controller_status_t::MODE_FAULT,         ///< latched; the drives hold the arm
  kEstop = controller_status_t::MODE_ESTOP,         ///< latched; a hardware stop is pressed
};
inline constexpr int kModes = 8;
/// As users read them, by Mode.
inline constexpr std::array<const char*, kModes> kModeNames = {
    "BOOT", "INIT", "IDLE", "HOLD", "ACTIVE", "SOFT_STOP", "FAULT", "ESTOP"};

enum class Event : std::uint8_t {
  // what a client asks
  kRequestIdle,
  kRequestHold,
  kRequestActive,
  kRequestStop,
  kRequestAcknowledge,
  // what the cycle sees
  kFirstState,    ///< a state has arrived
  kSteadyStates,  ///< enough good states in a row
  kAtRest,        ///< the soft stop is over
  // what goes wrong
  kStateLost,       ///< too many states missed, a joint silent, or no state at all
  kStateInvalid,    ///< not finite, or not this arm's
  kDriverFault,     ///< the drives no longer follow
  kNewSession,      ///< another run of the driver
  kTorqueInvalid,   ///< the law's result was not finite
  kDriveNotOn,      ///< the drives were asked for and did not come
  kStrayed,         ///< held, but it moves away
  kOverdriven,      ///< a motor makes a multiple of the torque that it reports
  kEncoderStopped,  ///< it must be moving, but its encoder does not count
  kEnergy,          ///< the arm moves with energy that its torques have not given it
  kClientSilent,    ///< the goal's time is over
  kEstopPressed,
};
inline constexpr int kEvents = 20;

struct Transition {
  Mode from;
  Event event;
  Mode to;
  /// REASON_* that is kept; REASON_NONE: leave it as it is.
  std::int8_t reason;
};

/// Every allowed transition. A request that is not listed is refused; any other event that is not
/// listed changes nothing.
std::span<const Transition> transitions() noexcept;

/// The row for an event in a mode, or nullptr. May be called in the cycle.
const Transition* find_transition(Mode mode, Event event) noexcept;

}  // namespace limber::controller
