// The stages of a joint between the drive's command and the link, as robot.yaml describes them.
//
//   command -> actuator -> rotor (and friction) -> gear -> spring, damper -> link (and friction)
//
// Everything is given at the joint, behind the gear. Units in names hold for rotary joints; for
// prismatic joints read m and N.
#pragma once

#include <cstdint>
#include <limits>

namespace limber {

/// What makes torque of the drive's command.
enum class ActuatorKind : std::uint8_t {
  kIdeal,         ///< the torque asked for
  kCurrentDrive,  ///< a current loop: first-order lag, within the supply's voltage and the current
  kVoltageDrive,  ///< no current loop: the voltage that gives the torque at standstill
  kHydraulic,     ///< a valve: tau' = K_h (c_l u - D_h theta' - c_l tau)
};

/// Zero or infinite: without that effect. Resistance and torque constant are in DriveConfig.
struct ActuatorConfig {
  ActuatorKind kind = ActuatorKind::kIdeal;
  double lag_s = 0.0;  ///< of the current loop
  double resistance_ohm = 0.1;
  double inductance_H = 0.0;
  double back_emf_Vs_per_rad = 0.0;  ///< at the joint
  double supply_V = std::numeric_limits<double>::infinity();
  double current_limit_A = std::numeric_limits<double>::infinity();
  double magnet_per_K = 0.0;  ///< change of the torque constant with temperature, negative
  double copper_per_K = 0.0;  ///< change of the resistance with temperature
  double thermal_resistance_K_per_W = 0.0;  ///< winding to ambient; 0: it stays cold
  double thermal_capacity_J_per_K = 100.0;
  double cogging_Nm = 0.0;                 ///< amplitude
  int cogging_periods = 0;                 ///< per joint revolution
  double fluid_stiffness_Nm_per_m3 = 0.0;  ///< K_h
  double leakage_m3_per_s_per_Nm = 0.0;    ///< c_l
  double displacement_m3_per_rad = 0.0;    ///< D_h
};

/// LuGre friction (control theory: bristle model). Zero: none.
struct FrictionConfig {
  double coulomb_Nm = 0.0;
  double static_Nm = 0.0;  ///< breakaway, at least coulomb_Nm
  double stribeck_rad_per_s = 0.05;
  double viscous_Nms_per_rad = 0.0;
  double bristle_rad = 1e-4;  ///< presliding deflection at coulomb_Nm
};

enum class TransmissionKind : std::uint8_t {
  kRigid,         ///< theta = q: the link carries the rotor
  kElastic,       ///< a spring between gear and link: flexible joint, series elastic actuator
  kAntagonistic,  ///< two motors that pull against each other, each through a spring
};

/// Torque of a spring over its deflection d; pull-only laws are slack for d < 0 in an antagonistic
/// joint, and odd in d in an elastic one.
enum class SpringLaw : std::uint8_t {
  kLinear,       ///< stiffness d
  kQuadratic,    ///< k2 d^2 / 2, pull-only
  kCubic,        ///< stiffness d + k3 d^3
  kExponential,  ///< force (exp(rate d) - 1), pull-only
  kSinh,         ///< force sinh(rate d)
};

struct SpringConfig {
  SpringLaw law = SpringLaw::kLinear;
  double stiffness_Nm_per_rad = 0.0;
  double k2_Nm_per_rad2 = 0.0;
  double k3_Nm_per_rad3 = 0.0;
  double force_Nm = 0.0;
  double rate_per_rad = 0.0;
};

/// Elastic: the spring's deflection is theta - q. Antagonistic: theta_1 - q and theta_2 + q; with
/// preload c = (theta_1 + theta_2) / 2 and equilibrium e = (theta_1 - theta_2) / 2 a quadratic
/// spring gives stiffness 2 k2 c and torque 2 k2 c (e - q).
struct TransmissionConfig {
  TransmissionKind kind = TransmissionKind::kRigid;
  SpringConfig spring;
  double damping_Nms_per_rad = 0.0;  ///< in parallel to the spring, motor against link
  double backlash_rad = 0.0;         ///< full width, in series with the spring
  double preload_rad = 0.0;          ///< c at rest
  double preload_max_rad = 0.0;
};

/// What an encoder reads too much, besides its counts: bias + eccentricity sin(angle) + noise,
/// delay_s late. For the simulator.
struct EncoderErrors {
  double bias_rad = 0.0;
  double eccentricity_rad = 0.0;  ///< amplitude, once a joint revolution
  double noise_rad = 0.0;         ///< standard deviation of one reading
  double delay_s = 0.0;

  bool any() const {
    return bias_rad != 0.0 || eccentricity_rad != 0.0 || noise_rad != 0.0 || delay_s != 0.0;
  }
};

struct LinkEncoderConfig {
  bool present = false;
  int bits = 20;  ///< per joint revolution
  EncoderErrors errors;
};

/// Measures the torque on the link: reading = scale * torque + bias + noise, filtered, rounded.
struct TorqueSensorConfig {
  bool present = false;
  double resolution_Nm = 0.0;
  double noise_Nm = 0.0;  ///< standard deviation of one sample
  double bias_Nm = 0.0;
  double scale = 1.0;
  double filter_s = 0.0;  ///< time constant
  double delay_s = 0.0;
};

/// Joint torque loop in the drive: tau_m = rho u + (1 - rho) (tau + D_J / K_J tau').
struct TorqueLoopConfig {
  double inertia_ratio = 1.0;  ///< rho = B / B_theta; 1: no loop
  double rate_hz = 4000.0;
  double delay_s = 0.0;  ///< of the loop's own, besides the hold

  bool present() const { return inertia_ratio > 1.0; }
};

}  // namespace limber
