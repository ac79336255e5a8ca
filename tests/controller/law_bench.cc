#include "tests/controller/law_bench.h"

#include "controller/gains/read_gains.h"
#include "controller/laws/registry.h"

namespace limber::testing {

using controller::LawInputs;

LawBench::LawBench(const LoadedRobot& arm, const std::string& name)
    : robot(arm),
      model(robot),
      terms(model.size()),
      point(model.size()),
      state(model.size()),
      goal(model.size()),
      gains(controller::default_gains(robot.robot, controller::law_catalog().parameters)),
      estimates(model.size()),
      output(model.size()),
      entry(controller::laws()[static_cast<std::size_t>(controller::find_law(name))]),
      law_(entry.make({robot.robot, model})) {
  law_->start(inputs());
}

LawInputs LawBench::inputs() const {
  return {.point = point,
          .state = state,
          .terms = terms,
          .goal = goal,
          .gains = gains,
          .estimates = estimates,
          .dt_s = 1e-3,
          .stiffness_due = due,
          .damping_due = due};
}

void LawBench::start(const VectorJ& q, const VectorJ& v) {
  point.q = state.q = q;
  point.v = state.v = v;
  model.evaluate(q, v, &terms);
  law_->start(inputs());
}

const controller::LawOutput& LawBench::at(const VectorJ& q, const VectorJ& v) {
  point.q = state.q = q;
  point.v = state.v = v;
  model.evaluate(q, v, &terms);
  output.reset();
  law_->compute(inputs(), &output);
  return output;
}

VectorJ LawBench::with_gravity(const VectorJ& q, const VectorJ& v) {
  return at(q, v).tau() + terms.g;
}

VectorJ LawBench::composed(const VectorJ& q, const VectorJ& v) {
  VectorJ tau = at(q, v).tau();
  const controller::Compensation add =
      controller::chosen_compensation(entry.compensation, gains.settings.model_compensation);
  if (add.gravity) tau += terms.g;
  if (add.coriolis) tau += terms.Cv;
  return tau;
}

void LawBench::set_goal(const VectorJ& q) {
  goal.X_BD = model.tip_pose(q);
  goal.q_d = q;
}

}  // namespace limber::testing
