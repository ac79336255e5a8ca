// Inverse dynamics with a linear law inside (computed torque; Luh, Walker, Paul 1980).
//   tau = M (a_d - K_acc (q - q_d) - D_acc (v - v_d)) + C v + g       recursive Newton-Euler
// Gains in 1/s^2 and 1/s: the error of every joint is a linear oscillator of its own, in free
// motion. What a hand feels is M(q) K_acc, which turns with the arm. With `literal_stiffness` the
// matrix J^T K_x J stands in the place of K_acc, unit or not, to show what that does. The law gives
// M a; C v + g comes from the cycle, so that `bias` can take it away.
#include "controller/laws/law.h"

namespace limber::controller {
namespace {

class ComputedTorque : public Law {
 public:
  explicit ComputedTorque(const LoadedRobot& robot) : model_(robot) {}

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    MatrixJ K = in.gains.K_acc;
    if (in.gains.settings.literal_stiffness) {
      K.noalias() = in.terms.J.transpose() * in.gains.K_x * in.terms.J;
    }
    const VectorJ spring = -K * (in.state.q - in.goal.q_d);
    const VectorJ damper = -in.gains.D_acc * (in.state.v - in.goal.v_d);
    const VectorJ a = in.goal.a_d + spring + damper;
    out->tau_stiffness = in.terms.M_total * spring;
    out->tau_damping = in.terms.M_total * damper;
    out->tau_feedforward =
        model_.inverse_dynamics(in.state.q, in.state.v, a) - in.terms.g - in.terms.Cv;
    out->tau_feedforward -= out->tau_stiffness + out->tau_damping;
  }

 private:
  ArmModel model_;
};

}  // namespace

LawEntry computed_torque_law() {
  return {.name = "computed_torque",
          .summary = "inverse dynamics: joints as oscillators of their own",
          .needs = sensors::kMotorEncoder,
          .follows = Follows::kJointGoal,
          .composition = {.gravity = true, .coriolis = true},
          .make = [](const LoadedRobot& robot) -> std::unique_ptr<Law> {
            return std::make_unique<ComputedTorque>(robot);
          }};
}

}  // namespace limber::controller
