// A torque that keeps gears from sticking, for arms without torque sensors.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robots/loader/robot.h"

namespace limber::controller {

/// Every joint that has friction is made to swing, too little to see:
///
///   tau_i = A_i sin(2 pi f t),   A_i = kBreak F_c,i + 2 pi f M_ii v_0
///
/// With M_ii dv/dt = tau_i - F the speed swings by V >= v_0 about, also where the friction F is
/// kBreak times the modelled one, and the joint by V / (2 pi f): 0.6 mrad. On a joint that swings
/// the friction no longer depends on the sign of its slow motion v, but is in the mean
///
///   F_c (2 / pi) asin(v / V)  ~  d v,   d = 2 F_c / (pi V)
///
/// a damper, which holds nothing: a spring k draws the joint home with the time constant d / k.
/// Source: describing function of a relay with dither (A. Gelb, W. Vander Velde, Multiple-Input
/// Describing Functions, 1968). Its mean over a period is zero: it moves no joint by itself.
class Dither {
 public:
  static constexpr double kFrequency_Hz = 25.0;  ///< above the arm's own motion, far below 1 kHz
  static constexpr double kBreak = 3.0;
  static constexpr double kTurn_rad_per_s = 0.1;  ///< v_0
  static constexpr double kSlide_m_per_s = 0.03;  ///< v_0 of sliding joints
  static constexpr double kRise_s = 0.5;          ///< at once, it would kick a free joint away
  static constexpr double kMost = 0.25;           ///< of the joint's torque limit

  /// For set-up.
  explicit Dither(const Robot& robot) : F_(VectorJ::Zero(robot.size())), v0_(F_), most_(F_) {
    Eigen::Index i = 0;
    for (const JointConfig& joint : robot.joints) {
      const bool slides = joint.type == JointType::kPrismatic;
      F_[i] = kBreak * joint.friction.coulomb_Nm;
      if (F_[i] > 0.0) v0_[i] = slides ? kSlide_m_per_s : kTurn_rad_per_s;
      most_[i] = kMost * joint.torque_limit_Nm;
      ++i;
    }
  }

  /// It rises anew. In the cycle.
  void restart() noexcept { risen_ = 0.0; }
  /// The torque of the next cycle, N m, n; `inertia`: the diagonal of M with rotors, kg m^2; T in
  /// s. May be called in the cycle.
  VectorJ next(const VectorJ& inertia, double T) noexcept {
    constexpr double kOmega = 2.0 * std::numbers::pi * kFrequency_Hz;
    risen_ = std::min(1.0, risen_ + T / kRise_s);
    phase_ = std::remainder(phase_ + kOmega * T, 2.0 * std::numbers::pi);
    const VectorJ amplitude = F_ + kOmega * inertia.cwiseProduct(v0_);
    return risen_ * std::sin(phase_) * amplitude.cwiseMin(most_);
  }

 private:
  VectorJ F_;
  VectorJ v0_;
  VectorJ most_;
  double phase_ = 0.0;
  double risen_ = 0.0;
};

}  // namespace limber::controller
