// Joint springs and dampers with the goal's dynamics fed forward (PD+; Paden, Panja 1988).
//   tau = M a_d + C(q, v) v_d + g - K_q (q - q_d) - D_q (v - v_d)
// Exact tracking on an exact model, and the stiffness at the joints is K_q itself. C is the matrix
// of the Christoffel symbols, bilinear in its velocities: with c(x) = C(q, x) x,
//   C(q, v) v_d = (c(v + v_d) - c(v - v_d)) / 4.
#include "controller/impedance/chosen_damping.h"
#include "controller/laws/law.h"

namespace limber::controller {
namespace {

class PdPlus : public Law {
 public:
  explicit PdPlus(const LawArm& arm)
      : model_(arm.model), D_(MatrixJ::Zero(model_.size(), model_.size())) {}

  const char* check(const Gains& gains) const noexcept override {
    return gains.settings.model_compensation == ModelCompensation::kGravityCoriolis
               ? "model_compensation: pd_plus has its own Coriolis torque; choose law_default, "
                 "gravity or none"
               : nullptr;
  }

  void start(const LawInputs& in) noexcept override { design(in); }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    if (in.damping_due) design(in);
    const VectorJ& q = in.point.q;
    const VectorJ& v = in.point.v;
    const VectorJ& v_d = in.goal.v_d;
    const VectorJ error = q - in.goal.q_d;
    const VectorJ Cv_d = 0.25 * (model_.coriolis(q, v + v_d) - model_.coriolis(q, v - v_d));
    out->tau_stiffness = -in.gains.K_q * error;
    out->tau_damping = -D_ * (v - v_d);
    out->tau_feedforward = in.terms.M_total * in.goal.a_d + Cv_d;
    out->spring_energy_J = -0.5 * error.dot(out->tau_stiffness);
  }

 private:
  void design(const LawInputs& in) noexcept {
    D_ = chosen_joint_damping(in.gains, in.terms, in.gains.K_q, in.elastic);
  }

  ArmModel model_;
  MatrixJ D_;
};

}  // namespace

LawEntry pd_plus_law() {
  return {.name = "pd_plus",
          .summary = "joint springs and dampers, goal's dynamics fed forward",
          .needs = sensors::kMotorEncoder,
          .goal_type = GoalType::kJoints,
          .compensation = {.gravity = true},
          .potential = Potential::kJointSpring,
          .damped = DampedAt::kJoints,
          .make = [](const LawArm& arm) -> std::unique_ptr<Law> {
            return std::make_unique<PdPlus>(arm);
          }};
}

}  // namespace limber::controller
