// LuGre friction of one joint, advanced by an implicit step that is stable and passive whatever its
// parameters.
//
//   zdot = v - sigma0 |v| z / G(v),   G(v) = F_c + (F_s - F_c) exp(-(v / v_s)^2)
//   F    = sigma0 z + sigma1(v) zdot + d v,          the torque on the joint is -F
//
// Source: Canudas de Wit, Olsson, Astrom, Lischinsky, "A new model for control of systems with
// friction", IEEE TAC 40 (1995). A constant sigma1 can return energy at speed (Barabanov, Ortega,
// IEEE TAC 45, 2000); here 1/sigma1 = 1/sigma1(0) + |v| / (4 G), which makes the power lost,
// F v - d/dt (sigma0 z^2 / 2), a positive form in v and z. sigma1(0) damps the bristle on the bare
// rotor critically.
#pragma once

#include "robots/loader/robot.h"

namespace limber::sim {

/// A force that is affine in the velocity at the end of a step: F = offset + slope * v_end, slope
/// >= 0.
struct AffineForce {
  double offset = 0.0;
  double slope = 0.0;
};

class LugreFriction {
 public:
  LugreFriction() = default;
  LugreFriction(const FrictionConfig& config, double rotor_inertia);

  bool any() const noexcept { return has_bristle() || viscous_ > 0.0; }
  /// Else the guesses below count for nothing.
  bool has_bristle() const noexcept { return coulomb_ > 0.0; }

  /// Begins a step of length h > 0 at velocity v.
  void begin_step(double v, double h) noexcept;

  /// The friction of the step, with |v_end| in the bristle's decay taken as |v_guess|. For any
  /// guess the step dissipates: F * v_end * h >= change of the bristle's energy.
  AffineForce step_force(double v_guess) const noexcept;

  /// Ends the step at v_end: moves the bristle and returns F. With the guess that step_force() was
  /// last given, F is exactly the force v_end was solved with.
  double finish_step(double v_guess, double v_end) noexcept;

  void reset() noexcept { z_ = 0.0; }
  double bristle() const noexcept { return z_; }
  /// Energy stored in the bristle, J.
  double bristle_energy() const noexcept { return 0.5 * sigma0_ * z_ * z_; }

 private:
  struct Coefficients {
    double decay;   // 1 + h sigma0 |v| / G: how the bristle shrinks in the step
    double sigma1;  // at the guessed speed
  };
  Coefficients coefficients(double v_guess) const noexcept;

  double coulomb_ = 0.0;
  double static_ = 0.0;
  double stribeck_ = 1.0;
  double viscous_ = 0.0;
  double sigma0_ = 0.0;
  double sigma1_ = 0.0;
  double z_ = 0.0;
  // Of the step in progress.
  double h_ = 1.0;
  double decay_per_speed_ = 0.0;
  double sigma1_loss_per_speed_ = 0.0;
};

}  // namespace limber::sim
