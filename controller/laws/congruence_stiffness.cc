// Joint stiffness that presents a Cartesian one around a loaded posture, by the conservative
// congruence transformation (Chen, Kao 2000; Albu-Schaeffer, Hirzinger 2002; lecture equation 4).
//   tau = J_d^T F_ff - K_q (q - q_d) - K_v (v - v_d) + g,   K_q = J_d^T K_x J_d [+ K_G(-F_ff)]
// J_d at the joint goal q_d. In equilibrium the world pushes with -F_ff; without the geometric term
// K_G the tip then presents J^-T (K_q - K_G) J^-1 instead of K_x. `stiffness_terms: first` leaves
// it out. A constant spring, hence conservative; exact for small deviations. K_v by the joint
// damping design; it does not act in the null space, which is left to K_null and D_null.
#include "controller/impedance/chosen_damping.h"
#include "controller/impedance/stiffness_mapping.h"
#include "controller/laws/law.h"

namespace limber::controller {
namespace {

class CongruenceStiffness : public Law {
 public:
  explicit CongruenceStiffness(const LawArm& arm)
      : model_(arm.model),
        J_(Matrix6J::Zero(6, model_.size())),
        K_q_(MatrixJ::Zero(model_.size(), model_.size())),
        K_v_(K_q_) {}

  void start(const LawInputs& in) noexcept override {
    map(in);
    K_v_ = chosen_joint_damping(in.gains, in.terms, K_q_, in.elastic);
  }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    if (in.stiffness_due) map(in);
    // The design wants a spring: where the load makes it none, it takes the rest.
    if (in.damping_due) K_v_ = chosen_joint_damping(in.gains, in.terms, K_q_, in.elastic);
    const VectorJ error = in.point.q - in.goal.q_d;
    out->F = in.goal.F_ff;
    out->tau_stiffness = -K_q_ * error;
    out->tau_damping = -K_v_ * (in.point.v - in.goal.v_d);
    out->tau_feedforward = J_.transpose() * in.goal.F_ff;
    out->spring_energy_J = -0.5 * error.dot(out->tau_stiffness);
  }

 private:
  void map(const LawInputs& in) noexcept {
    J_ = model_.jacobian(in.goal.q_d);
    K_q_.noalias() = J_.transpose() * in.gains.K_x * J_;
    if (in.gains.settings.stiffness_terms != StiffnessTerms::kFirst) {
      K_q_ += geometric_term(J_, -in.goal.F_ff);
    }
  }

  ArmModel model_;
  Matrix6J J_;
  MatrixJ K_q_;
  MatrixJ K_v_;
};

}  // namespace

LawEntry congruence_stiffness_law() {
  return {
      .name = "congruence_stiffness",
      .summary =
          "joint stiffness that presents a Cartesian one around a loaded posture (lecture eq. 4)",
      .needs = sensors::kMotorEncoder,
      .goal_type = GoalType::kJointsAndWrench,
      .compensation = {.gravity = true, .null_space = true},
      .make = [](const LawArm& arm) -> std::unique_ptr<Law> {
        return std::make_unique<CongruenceStiffness>(arm);
      }};
}

}  // namespace limber::controller
