// State feedback of the elastic joint: motor position and joint torque with their rates
// (Albu-Schaeffer, Ott, Hirzinger 2007).
//   tau = g - K_P (theta - theta_d) - K_D theta' + K_T (g - tau_J) - K_S K_J^-1 tau_J'
//   K_P = (1 + K_T) K_q,  K_D = (1 + K_T) D_q,  K_S = K_T D_J,  theta_d = q_d + K_J^-1 g(q_d)
// The same as torque feedback with rho = 1 + K_T around u = g - K_q (theta - theta_d) - D_q theta':
// the motor seems rho times lighter, and so does its friction. D_q for (M + B / rho, K_q). g where
// the weight alone bends the springs to.
#include "controller/elastic/full_state_feedback.h"
#include "controller/elastic/joint_springs.h"
#include "controller/impedance/chosen_damping.h"
#include "controller/laws/law.h"
#include "controller/observers/filtered_difference.h"

namespace limber::controller {
namespace {

GainRow torque_gain = {
    .key = "torque_gain",
    .meaning =
        "K_T, what the motor adds to each N m that the joint torque lacks; the loop divides "
        "motor inertia and friction by 1 + K_T",
    .high = 20.0};

class FullState : public Law {
 public:
  explicit FullState(const LawArm& arm)
      : model_(arm.model),
        tau_rate_(model_.size(), kTorqueRateCorner_rad_per_s, 1.0 / arm.robot.rate_hz),
        D_(MatrixJ::Zero(model_.size(), model_.size())),
        D_J_(model_.size()) {
    law_ = {D_, D_, D_, D_, JointSprings(arm.robot).at_rest()};
    for (Eigen::Index i = 0; i < D_J_.size(); ++i) {
      D_J_[i] = arm.robot.joints[static_cast<std::size_t>(i)].transmission.damping_Nms_per_rad;
    }
  }

  const char* check(const Gains& gains) const noexcept override {
    return gains.settings.model_compensation == ModelCompensation::kLawDefault
               ? nullptr
               : "model_compensation: full_state has its own gravity torque; choose law_default";
  }

  void start(const LawInputs& in) noexcept override {
    tau_rate_.reset();
    design(in);
  }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    if (in.damping_due) design(in);
    const double K_T = in.gains.parameters.number(torque_gain);
    law_.K_P = (1.0 + K_T) * in.gains.K_q;
    law_.K_D = (1.0 + K_T) * D_;
    law_.K_T.diagonal().setConstant(K_T);
    law_.K_S.diagonal() = K_T * D_J_;
    const VectorJ theta_d = in.goal.q_d + model_.gravity(in.goal.q_d).cwiseQuotient(law_.K_J);
    const VectorJ error = in.state.theta - theta_d;
    const VectorJ& tau_dot = tau_rate_.update(in.state.tau_measured);
    out->tau_stiffness = -law_.K_P * error;
    out->tau_damping = -law_.K_D * in.state.theta_dot;
    const VectorJ all =
        law_.torque(error, in.state.theta_dot, in.state.tau_measured, tau_dot, in.terms.g);
    out->tau_feedforward = all - out->tau_stiffness - out->tau_damping;
  }

 private:
  void design(const LawInputs& in) noexcept {
    MatrixJ M = in.terms.M;
    M.diagonal() += in.terms.B / (1.0 + in.gains.parameters.number(torque_gain));
    D_ = chosen_joint_damping(in.gains, M, in.gains.K_q);
  }

  ArmModel model_;
  FilteredDifference<VectorJ> tau_rate_;
  MatrixJ D_;
  VectorJ D_J_;
  FullStateFeedback law_;
};

}  // namespace

LawEntry full_state_law() {
  return {.name = "full_state",
          .summary = "motor position and joint torque fed back",
          .needs = sensors::kMotorEncoder | sensors::kElasticJoints | sensors::kTorqueSensor,
          .goal_type = GoalType::kJoints,
          .compensation = {.gravity = false},
          .potential = Potential::kGravity,
          .parameters = {&torque_gain},
          .make = [](const LawArm& arm) -> std::unique_ptr<Law> {
            return std::make_unique<FullState>(arm);
          }};
}

}  // namespace limber::controller
