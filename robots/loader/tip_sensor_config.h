// A six-axis force/torque sensor between the last link and the tool, as robot.yaml describes it.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "robots/loader/protocols/tip_sensor_protocol.h"

namespace limber {

/// A value for each axis of the sensor: force x, y, z in N, torque x, y, z in N m.
using SixAxes = std::array<double, 6>;

/// Frame S is the sensor's: its axes and the point its torques are about. What it reads is the
/// wrench of everything behind it, tool and environment, on the sensor.
struct TipSensorConfig {
  std::string model;  ///< for messages only
  TipSensorProtocol protocol = TipSensorProtocol::kLimberFt;
  int bus = 0;  ///< index into Robot::buses
  std::uint32_t command_id = 0;
  std::array<std::uint32_t, 2> reply_ids{};  ///< the second one only for kRobotousRft
  double counts_per_N = 50.0;                ///< kRobotousRft, as set in the sensor
  double counts_per_Nm = 2000.0;

  double p_TS[3] = {0.0, 0.0, 0.0};          ///< sensor origin in tip axes, m
  double quat_TS[4] = {1.0, 0.0, 0.0, 0.0};  ///< w, x, y, z, unit length
  SixAxes range{};                           ///< both ways; beyond it the sensor saturates
  SixAxes bias{};                            ///< what it reads unloaded
  double tool_mass_kg = 0.0;                 ///< behind the sensor; part of the URDF's masses
  double p_SC[3] = {0.0, 0.0, 0.0};          ///< the tool's centre of mass in sensor axes, m

  // Used by the simulator only.
  SixAxes resolution{};  ///< 0: what the protocol's number format has
  SixAxes noise{};       ///< standard deviation, white
  std::uint32_t noise_seed = 1;
  double filter_time_constant_s = 0.0;  ///< first order; 0: none

  int replies() const { return traits_of(protocol).replies; }
};

}  // namespace limber
