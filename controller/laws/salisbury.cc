// Active stiffness control (Salisbury, CDC 1980): a Cartesian stiffness felt through the joints.
//   tau = -J^T K_x J (q - q_d) - K_v (v - v_d) + g
// J at the present pose, K_v constant: as given, or the joint damping design for J^T K_x J at the
// pose where the law started. Holds for small deviations; not conservative, since J turns with the
// arm. Without K_null and D_null a redundant arm's null space has neither stiffness nor damping.
#include "controller/impedance/chosen_damping.h"
#include "controller/laws/law.h"

namespace limber::controller {
namespace {

class Salisbury : public Law {
 public:
  explicit Salisbury(int joints)
      : J_start_(Matrix6J::Zero(6, joints)),
        M_start_(MatrixJ::Identity(joints, joints)),
        K_q_(MatrixJ::Zero(joints, joints)),
        K_v_(K_q_),
        kept_(joints) {}

  void start(const LawInputs& in) noexcept override {
    J_start_ = in.terms.J;
    M_start_ = in.terms.M_total;
    K_q_ = mapped(in.terms.J, in.gains.K_x);
    K_v_ = kept_.of(in.gains, M_start_, K_q_);
  }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    if (in.stiffness_due) K_q_ = mapped(in.terms.J, in.gains.K_x);
    // Constant over the workspace, not over the gains.
    if (in.damping_due) {
      K_v_ = kept_.of(in.gains, M_start_, mapped(J_start_, in.gains.K_x));
    }
    out->tau_stiffness = -K_q_ * (in.point.q - in.goal.q_d);
    out->tau_damping = -K_v_ * (in.point.v - in.goal.v_d);
  }

 private:
  static MatrixJ mapped(const Matrix6J& J, const Matrix6& K_x) noexcept {
    return J.transpose() * K_x * J;
  }

  Matrix6J J_start_;
  MatrixJ M_start_;
  MatrixJ K_q_;
  MatrixJ K_v_;
  KeptJointDamping kept_;
};

}  // namespace

LawEntry salisbury_law() {
  return {.name = "salisbury",
          .summary = "Cartesian stiffness mapped to the joints, constant joint damping",
          .needs = sensors::kMotorEncoder,
          .goal_type = GoalType::kJoints,
          .compensation = {.gravity = true, .null_space = true},
          .make = [](const LawArm& arm) -> std::unique_ptr<Law> {
            return std::make_unique<Salisbury>(arm.robot.size());
          }};
}

}  // namespace limber::controller
