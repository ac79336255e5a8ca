// What robot.yaml and robot.urdf say of one arm, checked, in SI. Plain data: no Eigen, no KDL, so
// that the driver and its gate stay small. The kinematic chain itself is in robots/load_robot.h.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/can_address.h"
#include "robots/loader/emergency_stop_config.h"
#include "robots/loader/hand_travel.h"
#include "robots/loader/joint_chain.h"
#include "robots/loader/tip_sensor_config.h"

namespace limber {

/// One CAN bus of the arm. `can` is the word a user changes to leave the simulator: see
/// common/can_address.h.
/// Class of CAN adapter, see adapter.h.
enum class CanAdapter : std::uint8_t { kNative, kUsb, kSlcan, kDamiaoSerial };

struct BusConfig {
  std::string name;
  std::string can;
  bool fd = false;
  int bitrate_bps = 1'000'000;
  int data_bitrate_bps = 5'000'000;  ///< FD data phase
  CanAdapter adapter = CanAdapter::kNative;
  /// How long the driver waits for replies, s after the start of a cycle; 0: as predicted for the
  /// bus (drivers/bus_load.h).
  double reply_window_s = 0.0;
};

struct DriveProtocol;  // protocols/drive_protocol.h

/// What a drive's command frames can carry. MIT: the ranges both sides of the link must agree on.
/// moteus: kp and kd are the gains configured in the drive, at scale 1; the others are infinite.
/// CiA 402: the torque that 32767 thousandths of the rated torque are; the others are infinite.
struct CommandRange {
  double position_rad = 12.5;
  double velocity_rad_per_s = 30.0;
  double torque_Nm = 10.0;
  double kp_Nm_per_rad = 500.0;
  double kd_Nms_per_rad = 5.0;
};

/// Data bytes of the frames that a drive and its driver exchange in a cycle, each at its longest.
struct FrameSizes {
  int command = 8;
  std::vector<int> replies = {8};
  std::uint32_t reply_step = 0;  ///< from the identifier of one reply to that of the next
  /// Identifiers of the replies, if each is asked for by a remote frame of its own, behind the
  /// command; empty: the command asks for all.
  std::vector<std::uint32_t> asked = {};
};

enum class NodeWatchdogReaction : std::uint8_t {
  kOff,   ///< power stage off: the joint is free but for friction
  kDamp,  ///< motor phases shorted: the joint is a passive damper
};

/// One motor with its drive. Torque, speed and inertia are given at the joint (behind the gear).
struct DriveConfig {
  std::string motor;                        ///< model name, for messages only
  const DriveProtocol* protocol = nullptr;  ///< set by the loader
  int bus = 0;                              ///< index into Robot::buses
  std::uint32_t command_id = 0;             ///< on the bus; 29 bits long above 0x7FF
  std::uint32_t reply_id = 0;               ///< likewise
  FrameSizes frames;                        ///< of a cycle
  double sign = 1.0;        ///< +1 or -1: joint angle = sign * (drive angle - offset)
  double offset_rad = 0.0;  ///< drive angle at joint zero
  CommandRange range;
  bool single_turn = false;  ///< counts from a single turn on when it is switched on
  double gear_ratio = 1.0;
  double rotor_inertia_kgm2 = 0.0;        ///< reflected: rotor inertia times gear ratio squared (B)
  double torque_constant_Nm_per_A = 1.0;  ///< at the joint
  double peak_torque_Nm = 0.0;            ///< current limit of the drive, as torque at the joint
  double short_circuit_damping_Nms = 0.0;  ///< joint damping with shorted phases (kDamp)
  double watchdog_s = 0.02;                ///< written to the drive
  NodeWatchdogReaction watchdog_reaction = NodeWatchdogReaction::kDamp;
  double timeout_torque_Nm = 5.0;  ///< moteus: most that brakes the joint after a time-out
  double rated_torque_Nm = 1.0;    ///< CiA 402: torques count in thousandths of it (6076h)
  int board = 0;                   ///< CubeMars: its generation, 1 to 3
  int pole_pairs = 21;             ///< CubeMars V3: of the rotor
  std::uint32_t firmware = 0;      ///< ODrive: major, minor, revision, a byte each
  std::array<std::uint16_t, 7> endpoints{};  ///< ODrive: of the firmware, odrive_endpoints.h
  double counts_per_turn = 16384.0;          ///< motor encoder, per joint revolution
  /// Above it the driver warns; infinite: never.
  double warning_temperature_degC = std::numeric_limits<double>::infinity();
  /// Above it the driver stops the arm while the drive can hold it; infinite: never.
  double limit_temperature_degC = std::numeric_limits<double>::infinity();
  ActuatorConfig actuator;          ///< what makes torque of the command; for the simulator
  double hold_kp_Nm_per_rad = 0.0;  ///< driver's own holding when the controller is lost
  double hold_kd_Nms_per_rad = 0.0;

  /// Identifier of a reply of a cycle.
  std::uint32_t reply(std::size_t i) const noexcept {
    return frames.asked.empty() ? reply_id + static_cast<std::uint32_t>(i) * frames.reply_step
                                : frames.asked[i];
  }
};

enum class JointType : std::uint8_t { kRevolute, kContinuous, kPrismatic };

/// One moving joint between base and tip, in order. Limits are the tighter of URDF and YAML.
/// Units in names hold for rotary joints; for prismatic joints read m, m/s, N.
struct JointConfig {
  std::string name;
  JointType type = JointType::kRevolute;
  double position_min = 0.0;  ///< -inf for continuous joints
  double position_max = 0.0;
  double velocity_limit = 0.0;  ///< rad/s
  double torque_limit_Nm = 0.0;
  double torque_rate_limit_Nm_per_s =
      0.0;  ///< what the gate lets pass from cycle to cycle, times the rate
  double home = 0.0;
  DriveConfig drive;
  bool has_antagonist = false;
  DriveConfig antagonist;  ///< second motor of an antagonistic joint; counts only if there is one
  TransmissionConfig transmission;
  FrictionConfig friction;       ///< of each motor, before the transmission
  FrictionConfig link_friction;  ///< behind it
  EncoderErrors motor_encoder;   ///< its counts are DriveConfig::counts_per_turn
  LinkEncoderConfig link_encoder;
  TorqueSensorConfig torque_sensor;
  TorqueLoopConfig torque_loop;

  int motors() const { return has_antagonist ? 2 : 1; }
  /// The drive of motor 0 or 1.
  const DriveConfig& motor(int index) const { return index == 0 ? drive : antagonist; }
  bool rigid() const { return transmission.kind == TransmissionKind::kRigid; }
  /// Rotor inertia behind the gear as it seems behind the drive's torque loop (B_theta), kg m^2.
  double apparent_rotor_inertia_kgm2() const {
    return drive.rotor_inertia_kgm2 / torque_loop.inertia_ratio;
  }
};

/// A hand behind the tip, closed and opened by one motor.
struct HandConfig {
  /// Its motor, as a joint of the driver that is none of the chain: named "hand", rad, N m. Its
  /// limits are a tenth of the travel beyond the table's ends.
  JointConfig drive;
  HandTravel travel;
  double stiffness_N_per_m = 0.0;    ///< of the width
  double damping_Ns_per_m = 0.0;     ///< likewise
  double force_limit_N = 0.0;        ///< of each finger
  double speed_limit_m_per_s = 0.0;  ///< of the width that is aimed at
  double hold_force_N = 0.0;         ///< once something is grasped
  double rated_torque_Nm = 0.0;      ///< for ever, at the motor behind its gear
  double heat_time_constant_s = 30.0;
  // For the simulator.
  double finger_mass_kg = 0.0;       ///< of each finger
  double p_TG[3] = {0.0, 0.0, 0.0};  ///< where objects are grasped, tip axes, m

  /// Of motor and fingers as the width moves them: B / s^2 + m / 2 at a slope s, kg.
  double mass_kg(double slope) const {
    return drive.drive.rotor_inertia_kgm2 / (slope * slope) + 0.5 * finger_mass_kg;
  }
};

/// Gains a robot starts with.
struct DefaultGains {
  std::vector<double> K_q;  ///< N m/rad, joint impedance and HOLD
  double joint_damping_ratio = 0.7;
  double K_x_translation_N_per_m = 500.0;
  double K_x_rotation_Nm_per_rad = 20.0;
  double damping_ratio = 0.7;
  std::vector<double> K_null;  ///< N m/rad
  std::vector<double> D_null;  ///< N m s/rad
};

struct Robot {
  std::string name;
  std::string folder;  ///< where robot.yaml lies; empty for a bare URDF
  std::string urdf_path;
  std::string base;
  std::string tip;
  double gravity[3] = {0.0, 0.0, -9.81};  ///< m/s^2 in axes of the base link
  double rate_hz = 1000.0;
  /// Net power the motors may put into the arm; infinite: no limit.
  double power_limit_W = std::numeric_limits<double>::infinity();
  /// Kinetic energy that may come from elsewhere than the motors:
  /// controller/watches/energy_watch.h.
  double energy_limit_J = 2.0;
  std::vector<BusConfig> buses;
  std::vector<JointConfig> joints;
  DefaultGains gains;
  bool has_drives = false;  ///< false for a bare URDF: fit for `check` and `eval`, not for running
  bool has_tip_sensor = false;
  TipSensorConfig tip_sensor;  ///< counts only if there is one
  std::optional<EmergencyStopConfig> emergency_stop;
  std::optional<HandConfig> hand;

  /// Joints of the chain; the hand is none.
  int size() const { return static_cast<int>(joints.size()); }
  std::vector<std::string> joint_names() const {
    std::vector<std::string> names;
    for (const JointConfig& joint : joints) names.push_back(joint.name);
    return names;
  }
  /// All that the driver commands: the joints, then the hand.
  std::vector<JointConfig> driven() const {
    std::vector<JointConfig> all = joints;
    if (hand) all.push_back(hand->drive);
    return all;
  }
  std::vector<std::string> driven_names() const {
    std::vector<std::string> names = joint_names();
    if (hand) names.push_back(hand->drive.name);
    return names;
  }
  /// With the hand's.
  int motors() const {
    int count = hand ? 1 : 0;
    for (const JointConfig& joint : joints) count += joint.motors();
    return count;
  }

  /// Every bus is limber's own user-space one: as punctual as this machine's scheduler, not as a
  /// wire.
  bool on_virtual_buses() const {
    for (const BusConfig& bus : buses) {
      if (!is_virtual(bus.can)) return false;
    }
    return !buses.empty();
  }
};

}  // namespace limber
