// A spring and a damper at every joint; also what HOLD uses.
//   tau = -K_q (q - q_d) - D_q (v - v_d) + g
// D_q by the joint damping design, from M with rotors at this pose, plus a floor where K_q is zero;
// or as given. Coriolis torque is not compensated unless asked for: for a goal at rest the energy
// v^T M v / 2 + (q - q_d)^T K_q (q - q_d) / 2 then never rises by itself.
#include "controller/impedance/chosen_damping.h"
#include "controller/laws/law.h"

namespace limber::controller {
namespace {

class JointPd : public Law {
 public:
  explicit JointPd(int joints) : D_(MatrixJ::Zero(joints, joints)) {}

  void start(const LawInputs& in) noexcept override { design(in); }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    if (in.damping_due) design(in);
    const VectorJ error = in.point.q - in.goal.q_d;
    out->tau_stiffness = -in.gains.K_q * error;
    out->tau_damping = -D_ * (in.point.v - in.goal.v_d);
    out->spring_energy_J = -0.5 * error.dot(out->tau_stiffness);
  }

 private:
  void design(const LawInputs& in) noexcept {
    D_ = chosen_joint_damping(in.gains, in.terms, in.gains.K_q, in.elastic);
  }

  MatrixJ D_;
};

}  // namespace

LawEntry joint_pd_law() {
  return {.name = "joint_pd",
          .summary = "spring and damper at every joint",
          .needs = sensors::kMotorEncoder,
          .goal_type = GoalType::kJoints,
          .compensation = {.gravity = true},
          .potential = Potential::kJointSpring,
          .damped = DampedAt::kJoints,
          .make = [](const LawArm& arm) -> std::unique_ptr<Law> {
            return std::make_unique<JointPd>(arm.robot.size());
          }};
}

}  // namespace limber::controller
