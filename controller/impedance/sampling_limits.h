// How stiff and how damped a sampled loop may be: rules for one mode.
//
// Mass m and viscous friction b of the device; the controller's spring K and damper, sampled every
// T seconds and held, its force late by t_d besides. Linear motion: kg, N s/m, N/m; for rotations
// read kg m^2, N m s/rad, N m/rad. Pure functions for set-up, design and tests; no errors: a limit
// that cannot be kept is 0.
#pragma once

#pragma GCC visibility push(default)
namespace limber::controller {

/// A hold acts as half a sample of delay, which turns K into the damping -K (T/2 + t_d):
///   K < (b + D) / (T/2 + t_d)
/// For modes that are slow against the delay (Gil, Sanchez, Hulin, Preusche, Hirzinger 2009).
/// `damping` is b + D.
double stiffness_limit(double damping, double T, double t_d) noexcept;

/// Passive against every passive partner, whatever the mass, with a damper B by backward difference
/// (negative allowed) and no delay (Colgate, Schenkel 1997):  b > K T / 2 + |B|.
double passive_stiffness_limit(double b, double B, double T) noexcept;

/// A free mass without damper or delay, exact:
///   K < b a (1 - p) / (1 - p (1 + a T)),  a = b / m,  p = exp(-a T);  2 b / T for a heavy mass.
double free_mass_stiffness_limit(double m, double b, double T) noexcept;

/// A damper by backward difference on a mass without friction, exact: B < 2 m / T, and with one
/// more sample of delay B < 2 (sqrt(2) - 1) m / T.
double damping_limit(double m, double T) noexcept;
double delayed_damping_limit(double m, double T) noexcept;

/// A delay t_d, b = 0, and a damper that grows with the spring, D = 2 zeta sqrt(K m):
///   K < (m / t_d^2) x^2 cos x,  cos x = sqrt(4 zeta^4 + 1) - 2 zeta^2.
/// For a sampled loop count its half sample in t_d.
double delay_stiffness_limit(double m, double zeta, double t_d) noexcept;

/// A wall felt by an encoder with steps of `delta` on a device with Coulomb friction F_c stays
/// quiet (Abbott, Okamura 2005):  K <= min(2 b / T, 2 F_c / delta).
double quantised_wall_stiffness_limit(double b, double F_c, double delta, double T) noexcept;

/// A torque that follows with the first-order lag tau_e > 0, exact (Routh):
///   K < (D + b) (1 / tau_e + b / m).
double torque_lag_stiffness_limit(double m, double b, double D, double tau_e) noexcept;

}  // namespace limber::controller
#pragma GCC visibility pop
