// Before the first cycle: is every motor there, and how long do its replies take?
#pragma once

#include <csignal>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "drivers/can/can_bus.h"
#include "robots/loader/robot.h"

namespace limber {

/// Listens for 0.25 s without sending: the first frame of somebody else's that commands a motor of
/// this arm or writes its settings, for a message ("joint3 (id 0x3 on can0), frame 0x3"); "" if
/// there is none. In real time, set-up only.
std::string find_foreign_command(const Robot& robot, std::span<CanBus* const> buses);

/// Sends every motor a read request ten times a second (a CANopen drive, whose server may be slow,
/// once) until all have answered; that moves, enables and disturbs nothing. Returns "" then, or
/// after `patience_s` (or when `stop` is set) the motors that are missing, for a message. Set-up
/// only.
/// `lockstep`: nodes behind a simulated wire, where time stands still. `tell`: given the motors
/// missing after 1.5 s, and again when others are; the waiting goes on.
std::string discover_drives(const Robot& robot, std::span<CanBus* const> buses, bool lockstep,
                            double patience_s, const volatile std::sig_atomic_t& stop,
                            const std::function<void(const std::string&)>& tell = {});

/// From sending a request to the kernel's stamp of the reply, ns.
struct RoundTrip {
  std::int64_t least_ns = 0;
  std::int64_t longest_ns = 0;
  int asked = 0;
  int answered = 0;
};
inline constexpr int kRoundTrips = 20;

/// Sends read requests to one motor of each bus, kRoundTrips times, alone on the bus. In the order
/// of robot.buses; a bus without motors, or with CANopen drives alone, has none answered. In real
/// time, set-up only.
std::vector<RoundTrip> measure_round_trips(const Robot& robot, std::span<CanBus* const> buses);

/// Motors that give two answers to one request, twice: two drives have the same id. "" if there are
/// none. In real time, set-up only.
std::string find_twins(const Robot& robot, std::span<CanBus* const> buses);

}  // namespace limber
