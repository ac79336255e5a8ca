// A spring and a damper at every joint; also what HOLD uses.
//   tau = -K_q (q - q_d) - D_q (v - v_d) + g
// D_q: double diagonalisation of (M with rotors, K_q), so that every mode has the joint damping
// ratio at this pose, plus a floor where K_q is zero. Coriolis torque is not compensated: for a
// goal at rest the energy v^T M v / 2 + (q - q_d)^T K_q (q - q_d) / 2 then never rises by itself.
#include "controller/damping_design.h"
#include "controller/laws/law.h"

namespace limber::controller {
namespace {

class JointImpedance : public Law {
 public:
  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    const VectorJ& K = in.gains.K_q;
    const VectorJ error = in.state.q - in.goal.q_d;
    const VectorJ rate = in.state.v - in.goal.v_d;
    const VectorJ spring = K.cwiseProduct(error);
    out->tau_stiffness = -spring;
    out->spring_energy_J = 0.5 * error.dot(spring);
    const MatrixJ D = joint_damping(in.terms.M_total, K, in.gains.joint_damping_ratio);
    out->tau_damping = -D * rate;
    out->tau_damping -= joint_damping_floor(in.terms.M_total, K).cwiseProduct(rate);
  }
};

}  // namespace

LawEntry joint_impedance_law() {
  return {.name = "joint_impedance",
          .summary = "spring and damper at every joint",
          .needs = sensors::kLinkEncoder,
          .follows = Follows::kJointGoal,
          .composition = {.gravity = true},
          .make = [](const LoadedRobot&) -> std::unique_ptr<Law> {
            return std::make_unique<JointImpedance>();
          }};
}

}  // namespace limber::controller
