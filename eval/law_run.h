// One law of the controller at one state, outside the cycle.
#pragma once

#include <string>

#include "controller/laws/law.h"
#include "eval/arm.h"

namespace limber::eval {

/// Share of the tip's greatest mobility below which a direction counts as lost, see nullspace.h:
/// exact but at a singularity.
inline constexpr double kLostOnlyWhenSingular = 1e-12;

/// The law with its damping as given, its spring without a limit of its force, and inverses that
/// are damped nowhere but at a singularity. Fill in state, goal, gains and estimates, then ask for
/// the torque.
class LawRun {
 public:
  /// Reads q and v, and evaluates the terms there.
  LawRun(Arm* arm, const std::string& law, Inputs& in);

  /// The law's torque and the model torque that the settings ask for, N m. Throws ConfigError if
  /// the law refuses the gains.
  VectorJ torque();

  Arm& arm;
  controller::ArmTerms terms;
  controller::ArmState state;
  controller::Goal goal;
  controller::Gains gains;
  controller::Estimates estimates;
  controller::LawOutput output;

 private:
  const controller::LawEntry& entry_;
};

}  // namespace limber::eval
