#include "eval/law_run.h"

#include <limits>

#include "common/config_error.h"
#include "controller/laws/registry.h"

namespace limber::eval {
namespace {

using namespace controller;

LawSettings exact_settings() {
  LawSettings settings;
  settings.damping = DampingDesign::kGiven;
  settings.joint_damping = DampingDesign::kGiven;
  settings.spring_force_N = std::numeric_limits<double>::infinity();
  settings.spring_moment_Nm = std::numeric_limits<double>::infinity();
  settings.lost_share = kLostOnlyWhenSingular;
  return settings;
}

}  // namespace

LawRun::LawRun(Arm* given, const std::string& law, Inputs& in)
    : arm(*given),
      terms(arm.terms(in)),
      state(arm.model.size()),
      goal(arm.model.size()),
      gains(arm.model.size()),
      estimates(arm.model.size()),
      output(arm.model.size()),
      entry_(laws()[static_cast<std::size_t>(find_law(law))]) {
  state.q = in.vector("q", arm.size());
  state.v = in.vector_or_zero("v", arm.size());
  goal.X_BD = terms.X_BT;
  gains.settings = exact_settings();
}

VectorJ LawRun::torque() {
  if (entry_.refuse != nullptr) {
    if (const char* reason = entry_.refuse(gains, arm.model.size())) throw ConfigError(reason);
  }
  const LawInputs inputs{state, state, terms, goal, gains, estimates};
  const auto law = entry_.make(arm.robot);
  law->start(inputs);
  output.reset();
  law->compute(inputs, &output);
  const Composition add = with_bias(entry_.composition, gains.settings.bias);
  VectorJ tau = output.tau();
  if (add.gravity) tau += terms.g;
  if (add.coriolis) tau += terms.Cv;
  return tau;
}

}  // namespace limber::eval
