#include "tests/controller/law_bench.h"

namespace limber::testing {

using controller::LawInputs;

LawBench::LawBench(const LoadedRobot& arm, const std::string& name)
    : robot(arm),
      model(robot),
      terms(model.size()),
      state(model.size()),
      goal(model.size()),
      gains(controller::default_gains(robot.robot)),
      estimates(model.size()),
      output(model.size()),
      law_(controller::laws()[static_cast<std::size_t>(controller::find_law(name))].make(robot)) {
  law_->start({state, terms, goal, gains, estimates});
}

const controller::LawOutput& LawBench::at(const VectorJ& q, const VectorJ& v) {
  state.q = q;
  state.v = v;
  model.evaluate(q, v, &terms);
  output.reset();
  law_->compute(LawInputs{state, terms, goal, gains, estimates}, &output);
  return output;
}

VectorJ LawBench::with_gravity(const VectorJ& q, const VectorJ& v) {
  return at(q, v).tau() + terms.g;
}

void LawBench::set_goal(const VectorJ& q) {
  goal.X_BD = model.tip_pose(q);
  goal.q_d = q;
}

}  // namespace limber::testing
