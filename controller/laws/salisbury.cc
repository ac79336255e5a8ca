// Active stiffness control (Salisbury, CDC 1980): a Cartesian stiffness felt through the joints.
//   tau = -J^T K_x J (q - q_d) - K_v (v - v_d) + g
// J at the present pose, K_v constant: as given, or the joint damping design for J^T K_x J at the
// pose where the law started. Holds for small deviations; not conservative, since J turns with the
// arm; the null space has damping only.
#include "controller/chosen_damping.h"
#include "controller/laws/law.h"
#include "controller/stiffness_mapping.h"

namespace limber::controller {
namespace {

class Salisbury : public Law {
 public:
  explicit Salisbury(int joints)
      : K_q_(MatrixJ::Zero(joints, joints)), K_v_(MatrixJ::Zero(joints, joints)) {}

  void start(const LawInputs& in) noexcept override {
    map(in);
    K_v_ = chosen_joint_damping(in.gains, in.terms.M_total, K_q_);
  }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    if (in.stiffness_due) map(in);
    const bool given = in.gains.settings.joint_damping == DampingDesign::kGiven;
    out->tau_stiffness = -K_q_ * (in.state.q - in.goal.q_d);
    out->tau_damping = -(given ? in.gains.D_q : K_v_) * (in.state.v - in.goal.v_d);
  }

 private:
  void map(const LawInputs& in) noexcept {
    K_q_.noalias() = in.terms.J.transpose() * in.gains.K_x * in.terms.J;
  }

  MatrixJ K_q_;
  MatrixJ K_v_;
};

}  // namespace

LawEntry salisbury_law() {
  return {.name = "salisbury",
          .summary = "Cartesian stiffness mapped to the joints, constant joint damping",
          .needs = sensors::kLinkEncoder,
          .follows = Follows::kJointGoal,
          .composition = {.gravity = true},
          .make = [](const LoadedRobot& robot) -> std::unique_ptr<Law> {
            return std::make_unique<Salisbury>(robot.robot.size());
          }};
}

}  // namespace limber::controller
