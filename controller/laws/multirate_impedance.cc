// Cartesian impedance at a slow rate, a joint spring in between (multi-rate form).
//   at q_k, every `period_cycles` of the stiffness:
//     tau_k = -J^T A^T K_x e + J^T F_ff,  K_k = d(J^T A^T K_x e)/dq (or its first term alone)
//   every cycle:  tau = tau_k - K_k (q - q_k) - K_v v + g,  K_v = J^T D_x J
// The error since the last evaluation is of second order in the motion with the full tangent, of
// first order with the first term. V_d enters through K_v at the slow rate.
#include "controller/impedance/chosen_damping.h"
#include "controller/impedance/stiffness_mapping.h"
#include "controller/laws/law.h"

namespace limber::controller {
namespace {

class MultirateImpedance : public Law {
 public:
  explicit MultirateImpedance(const LawArm& arm)
      : model_(arm.model),
        q_(VectorJ::Zero(model_.size())),
        tau_(q_),
        tau_goal_(q_),
        K_q_(MatrixJ::Zero(model_.size(), model_.size())),
        K_v_(K_q_) {}

  void start(const LawInputs& in) noexcept override {
    map_stiffness(in);
    map_damping(in);
  }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    if (in.stiffness_due) map_stiffness(in);
    if (in.damping_due) map_damping(in);
    out->tau_stiffness = tau_ - K_q_ * (in.point.q - q_);
    out->tau_damping = tau_goal_ - K_v_ * in.point.v;
    out->tau_feedforward = in.terms.J.transpose() * in.goal.F_ff;
  }

 private:
  void map_stiffness(const LawInputs& in) noexcept {
    const LawSettings& s = in.gains.settings;
    q_ = in.point.q;
    tau_ = -holding_torque(&model_, q_, in.goal.X_BD, in.gains.K_x, s.orientation);
    K_q_ =
        joint_stiffness(s.stiffness_terms, &model_, q_, in.goal.X_BD, in.gains.K_x, s.orientation);
  }

  void map_damping(const LawInputs& in) noexcept {
    const Matrix6 D_x = chosen_tip_damping(in.gains, in.terms, in.elastic);
    K_v_.noalias() = in.terms.J.transpose() * D_x * in.terms.J;
    tau_goal_.noalias() = in.terms.J.transpose() * (D_x * in.goal.V_BD);
  }

  ArmModel model_;
  VectorJ q_;
  VectorJ tau_;
  VectorJ tau_goal_;
  MatrixJ K_q_;
  MatrixJ K_v_;
};

}  // namespace

LawEntry multirate_impedance_law() {
  return {.name = "multirate_impedance",
          .summary = "Cartesian impedance at a slow rate, its tangent stiffness in between",
          .needs = sensors::kMotorEncoder,
          .goal_type = GoalType::kPose,
          .compensation = {.gravity = true, .null_space = true},
          .damped = DampedAt::kTip,
          .make = [](const LawArm& arm) -> std::unique_ptr<Law> {
            return std::make_unique<MultirateImpedance>(arm);
          }};
}

}  // namespace limber::controller
