#include "lecture/eval/law_run.h"

#include <limits>

#include "common/config_error.h"
#include "controller/laws/registry.h"

namespace limber::eval {
namespace {

using namespace controller;

LawSettings exact_settings() {
  LawSettings settings = default_settings();
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
      point(arm.model.size()),
      state(arm.model.size()),
      goal(arm.model.size()),
      gains(arm.model.size(), law_catalog().parameters),
      estimates(arm.model.size()),
      output(arm.model.size()),
      entry_(laws()[static_cast<std::size_t>(find_law(law))]) {
  point.q = state.q = in.vector("q", arm.size());
  point.v = state.v = in.vector_or_zero("v", arm.size());
  goal.X_BD = terms.X_BT;
  gains.settings = exact_settings();
}

VectorJ LawRun::torque() {
  const LawInputs inputs{point, state, terms, goal, gains, estimates};
  const auto law = entry_.make({arm.robot.robot, arm.model});
  if (const char* reason = law->check(gains)) throw ConfigError(reason);
  law->start(inputs);
  output.reset();
  law->compute(inputs, &output);
  const Compensation add =
      chosen_compensation(entry_.compensation, gains.settings.model_compensation);
  VectorJ tau = output.tau();
  if (add.gravity) tau += terms.g;
  if (add.coriolis) tau += terms.Cv;
  return tau;
}

}  // namespace limber::eval
