// The load that an arm puts on its buses and the time that a cycle's traffic takes, known before
// the first frame. All of it is for set-up, not for the cycle.
#pragma once

#include "robots/loader/robot.h"

namespace limber {

/// Share of the bus, 0..1, that a command and its replies per motor and cycle, the SYNC of CANopen
/// drives, the tip sensor's frames and the reading of settings take at robot.rate_hz, every frame
/// at its longest.
double predicted_bus_load(const Robot& robot, int bus);

/// The same with frames of the usual length: exact identifiers, the mean over typical data. What
/// the driver counts agrees with it within 3 %.
double expected_bus_load(const Robot& robot, int bus);

/// When the driver has the last reply of a cycle at the latest, s after its start: every frame at
/// its longest, the adapter's delays and jitter, the drives' reply delay.
double predicted_end_s(const Robot& robot, int bus);
/// The soonest that a reply can follow the start of the cycle, s.
double least_round_trip_s(const Robot& robot, int bus);

/// Share of the period in which the driver waits for replies at the most: the rest is the
/// controller's.
inline constexpr double kLatestReply = 0.9;

/// How long the driver waits for replies, s after the start of a cycle, on the slowest bus: its
/// reply_window_s of robot.yaml; else the predicted end and a twentieth of the period, or one frame
/// of another device if that is longer, within 0.6 and 0.9 of the period.
double reply_window_s(const Robot& robot);
/// Rate at which the predicted end is the latest that the driver waits for, Hz; infinite if no
/// motor is on the bus.
double highest_rate_hz(const Robot& robot, int bus);

/// expected_bus_load(); throws ConfigError if the robot's rate is above highest_rate_hz(), or the
/// bus's reply_window_s is longer than kLatestReply.
double checked_bus_load(const Robot& robot, int bus);

/// Throws ConfigError if a cycle has no room for frames that take `delay_s` longer each way than
/// predicted, as `wire.delay_s` of the scenario in `file` wants.
void check_wire_delay(const Robot& robot, double delay_s, const std::string& file);

}  // namespace limber
