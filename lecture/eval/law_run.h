// One law of the controller at one state, outside the cycle.
#pragma once

#include <string>

#include "controller/laws/registry.h"
#include "lecture/eval/arm.h"

namespace limber::eval {

/// Share of the tip's greatest mobility below which a direction counts as lost, see nullspace.h:
/// exact but at a singularity.
inline constexpr double kLostOnlyWhenSingular = 1e-12;

/// The law with its damping as given, its spring without a limit of its force, and inverses that
/// are damped nowhere but at a singularity. Fill in state, goal, gains and estimates, then take
/// the torque.
class LawRun {
 public:
  /// Reads q and v, and evaluates the terms there.
  LawRun(Arm* arm, const std::string& law, Inputs& in);

  /// The law's torque with the model torque that the settings choose, N m. Throws ConfigError if
  /// the law refuses the gains.
  VectorJ torque();
  /// The value of a parameter of this law, by its key.
  template <typename Value>
  void set(const char* key, const Value& value) {
    gains.parameters.set(*find_row(controller::law_catalog().parameters, key), value);
  }

  Arm& arm;
  controller::ArmTerms terms;
  controller::ControlPoint point;
  controller::ArmState state;
  controller::Goal goal;
  controller::Gains gains;
  controller::Estimates estimates;
  controller::LawOutput output;

 private:
  const controller::LawEntry& entry_;
};

}  // namespace limber::eval
