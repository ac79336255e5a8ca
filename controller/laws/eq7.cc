// Cartesian impedance in joint form: gains at a pose, times the finite joint error.
//   tau = K_p (q_d - q) + K_v (s v_d - v) + g,   s = 1 with `follow_velocity`, else 0
//   K_v = J^T D_x J at the present pose
// K_p by `stiffness_terms` at `stiffness_pose`; q_d from inverse kinematics where the goal is at
// the tip. A tangent used as a secant: against -J^T A^T K_x e the torque is off in first order of
// the deviation, except at the mid pose with the full tangent, or the mean of both ends, where it
// is second order better and conservative; cartesian_impedance is exact. `damping_partials` shows
// what the derivative of the damping torque does, in the stiffness, where it belongs, or in the
// damping, as one finds it printed.
#include "controller/chosen_damping.h"
#include "controller/laws/law.h"
#include "controller/stiffness_mapping.h"

namespace limber::controller {
namespace {

class Eq7 : public Law {
 public:
  explicit Eq7(const LoadedRobot& robot)
      : model_(robot), K_p_(MatrixJ::Zero(model_.size(), model_.size())), K_v_(K_p_) {}

  void start(const LawInputs& in) noexcept override { map(in); }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    if (in.stiffness_due || in.damping_due) map(in);
    out->tau_stiffness = K_p_ * (in.goal.q_d - in.state.q);
    out->tau_damping = -K_v_ * in.state.v;
    if (in.gains.settings.follow_velocity) out->tau_damping += K_v_ * in.goal.v_d;
    out->tau_feedforward = in.terms.J.transpose() * in.goal.F_ff;
  }

 private:
  void map(const LawInputs& in) noexcept {
    const Eq7Gains mapped = eq7_gains(&model_, in.state.q, in.state.v, in.goal, in.gains,
                                      chosen_tip_damping(in.gains, in.terms));
    if (in.stiffness_due) K_p_ = mapped.K_p;
    if (in.damping_due) K_v_ = mapped.K_v;
  }

  ArmModel model_;
  MatrixJ K_p_;
  MatrixJ K_v_;
};

}  // namespace

LawEntry eq7_law() {
  return {.name = "eq7",
          .summary = "Cartesian impedance as joint gains times the finite joint error",
          .needs = sensors::kMotorEncoder,
          .follows = Follows::kJointGoalAndWrench,
          .composition = {.gravity = true, .null_space = true},
          .make = [](const LoadedRobot& robot) -> std::unique_ptr<Law> {
            return std::make_unique<Eq7>(robot);
          }};
}

}  // namespace limber::controller
