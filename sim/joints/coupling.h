// A motor over one implicit step, seen from its link.
//
// Motor and link share T = T_0 + G (a - side qdd) with their accelerations a and qdd, where
// G = h^2 K / 4 + h D / 2: spring and damper by the average acceleration method (Newmark, "A method
// of computation for structural dynamics", ASCE J. Eng. Mech. 85, 1959), stable for every step and
// without damping of its own. A servo in the drive, kp and kd, adds h^2 kp / 4 + h kd / 2 to the
// rotor's inertia in the same way. With J a = u - T the motor drops out:
//
//   side T = side (T_0 + (u - T_0) G / (J + G)) - qdd J G / (J + G)
//
// which is the rotor on a rigid shaft, u - J qdd, for G -> infinity.
#pragma once

namespace limber::sim {

/// A value; allowed in the cycle throughout.
struct Coupling {
  double side = 1.0;
  double inertia = 1.0;      ///< J, kg m^2
  double servo = 0.0;        ///< the servo's part of J: its torque in the step is less by servo a
  double drive = 0.0;        ///< u: torque on the motor but for the transmission's, N m
  double transmitted = 0.0;  ///< T_0
  double gain = 0.0;         ///< G
  bool rigid = true;         ///< the rotor is part of the link's body; J is what comes on top

  double link_torque() const noexcept {
    if (rigid) return drive;
    return side * (transmitted + (drive - transmitted) * gain / (inertia + gain));
  }
  /// What the link's inertia seems larger by.
  double link_inertia() const noexcept {
    return rigid ? inertia : inertia * gain / (inertia + gain);
  }
  double acceleration(double qdd) const noexcept {
    if (rigid) return qdd;
    return (drive - transmitted + gain * side * qdd) / (inertia + gain);
  }
};

}  // namespace limber::sim
