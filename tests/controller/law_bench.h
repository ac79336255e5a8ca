// One law at one arm, outside the cycle: evaluate it anywhere.
#pragma once

#include <string>

#include "controller/laws/registry.h"
#include "tests/controller/arms.h"

namespace limber::testing {

class LawBench {
 public:
  LawBench(const LoadedRobot& arm, const std::string& name);

  /// The law's output at (q, v); terms are left in `terms`.
  const controller::LawOutput& at(const VectorJ& q, const VectorJ& v);
  /// Its torque with gravity, without Coriolis and null space: a continuous-time feedback.
  VectorJ with_gravity(const VectorJ& q, const VectorJ& v);
  /// As the cycle composes it, without the null space.
  VectorJ composed(const VectorJ& q, const VectorJ& v);
  /// The law starts at (q, v).
  void start(const VectorJ& q, const VectorJ& v);
  /// The goal is where the arm is at q.
  void set_goal(const VectorJ& q);
  /// The value of a parameter of a law, by its key.
  template <typename Value>
  void set(const char* key, const Value& value) {
    gains.parameters.set(*find_row(controller::law_catalog().parameters, key), value);
  }
  const MatrixJ& matrix(const char* key) const {
    return gains.parameters.matrix(*find_row(controller::law_catalog().parameters, key));
  }
  /// nullptr, or why the law cannot work with the gains.
  const char* check() const { return law_->check(gains); }
  const controller::Law& law() const { return *law_; }

  LoadedRobot robot;
  controller::ArmModel model;
  controller::ArmTerms terms;
  controller::ControlPoint point;
  controller::ArmState state;
  controller::Goal goal;
  controller::Gains gains;
  controller::Estimates estimates;
  controller::LawOutput output;
  bool due = true;  ///< what the law derives from stiffness and damping, it may derive anew
  const controller::LawEntry& entry;

 private:
  controller::LawInputs inputs() const;

  std::unique_ptr<controller::Law> law_;
};

}  // namespace limber::testing
