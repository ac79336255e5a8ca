// Joint stiffness that presents a Cartesian one around a loaded posture (Albu-Schaeffer, Hirzinger
// 2002; Chen, Kao 2000).
//   tau = J_d^T F_ff - K_q (q - q_d) - K_v (v - v_d) + g,   K_q = J_d^T K_x J_d [+ K_G(-F_ff)]
// J_d at the joint goal q_d. In equilibrium the world pushes with -F_ff; without the geometric term
// K_G the tip then presents J^-T (K_q - K_G) J^-1 instead of K_x. `stiffness_terms: first` leaves
// it out. A constant spring, hence conservative; exact for small deviations. K_v by the joint
// damping design; it has nothing to say in the null space, which K_null and D_null look after.
#include "controller/chosen_damping.h"
#include "controller/laws/law.h"
#include "controller/stiffness_mapping.h"

namespace limber::controller {
namespace {

class Eq4 : public Law {
 public:
  explicit Eq4(const LoadedRobot& robot)
      : model_(robot),
        J_(Matrix6J::Zero(6, model_.size())),
        K_q_(MatrixJ::Zero(model_.size(), model_.size())),
        K_v_(K_q_) {}

  void start(const LawInputs& in) noexcept override {
    map(in);
    K_v_ = chosen_joint_damping(in.gains, in.terms.M_total, K_q_);
  }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    if (in.stiffness_due) map(in);
    // The design wants a spring: where the load makes it none, it takes the rest.
    if (in.damping_due) K_v_ = chosen_joint_damping(in.gains, in.terms.M_total, K_q_);
    const VectorJ error = in.state.q - in.goal.q_d;
    out->F = in.goal.F_ff;
    out->tau_stiffness = -K_q_ * error;
    out->tau_damping = -K_v_ * (in.state.v - in.goal.v_d);
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

LawEntry eq4_law() {
  return {.name = "eq4",
          .summary = "joint stiffness for a Cartesian one around a loaded posture",
          .needs = sensors::kMotorEncoder,
          .follows = Follows::kJointGoalAndWrench,
          .composition = {.gravity = true, .null_space = true},
          .make = [](const LoadedRobot& robot) -> std::unique_ptr<Law> {
            return std::make_unique<Eq4>(robot);
          }};
}

}  // namespace limber::controller
