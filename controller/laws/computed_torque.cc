// Inverse dynamics with a linear law inside (computed torque; Luh, Walker, Paul 1980).
//   tau = M (a_d - K_acc (q - q_d) - D_acc (v - v_d)) + C v + g       recursive Newton-Euler
// Gains in 1/s^2 and 1/s: the error of every joint is a linear oscillator of its own, in free
// motion. What a hand feels is M(q) K_acc, which turns with the arm. With `literal_stiffness` the
// matrix J^T K_x J stands in the place of K_acc, unit or not, to show what that does. The law gives
// M a; C v + g comes from the cycle, so that `model_compensation` can take it away.
#include "controller/laws/law.h"

namespace limber::controller {
namespace {

GainRow K_acc = {.key = "K_acc_per_s2",
                 .meaning = "stiffness per inertia; its damping has the joint damping ratio",
                 .unit = "1/s²",
                 .high = 1e5,
                 .standard = 100.0,
                 .per_joint = true,
                 .ramps = true};
GainRow D_acc = {.key = "D_acc_per_s",
                 .meaning = "damping per inertia for `joint_damping: given`",
                 .unit = "1/s",
                 .high = 1e3,
                 .per_joint = true,
                 .ramps = true};
constexpr GainWord kLiteral[] = {{"false", 0}, {"true", 1, true}};
GainRow literal_stiffness = {
    .key = "literal_stiffness",
    .meaning =
        "a demonstration: J^T K_x J in the place of the stiffness per inertia, whose unit it "
        "does not have",
    .words = kLiteral};

class ComputedTorque : public Law {
 public:
  explicit ComputedTorque(const LawArm& arm) : model_(arm.model) {}

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    const LawParameters& own = in.gains.parameters;
    MatrixJ K = own.matrix(K_acc);
    const MatrixJ D = in.gains.settings.joint_damping == DampingDesign::kGiven
                          ? own.matrix(D_acc)
                          : MatrixJ(2.0 * in.gains.joint_damping_ratio * K.cwiseSqrt());
    if (own.on(literal_stiffness)) {
      K.noalias() = in.terms.J.transpose() * in.gains.K_x * in.terms.J;
    }
    const VectorJ spring = -K * (in.point.q - in.goal.q_d);
    const VectorJ damper = -D * (in.point.v - in.goal.v_d);
    const VectorJ a = in.goal.a_d + spring + damper;
    out->tau_stiffness = in.terms.M_total * spring;
    out->tau_damping = in.terms.M_total * damper;
    out->tau_feedforward =
        model_.inverse_dynamics(in.point.q, in.point.v, a) - in.terms.g - in.terms.Cv;
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
          .goal_type = GoalType::kJoints,
          .compensation = {.gravity = true, .coriolis = true},
          .parameters = {&K_acc, &D_acc, &literal_stiffness},
          .make = [](const LawArm& arm) -> std::unique_ptr<Law> {
            return std::make_unique<ComputedTorque>(arm);
          }};
}

}  // namespace limber::controller
