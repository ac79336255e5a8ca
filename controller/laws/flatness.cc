// Follows a joint motion through the springs: all that the motor has to do is known from the link's
// motion to its fourth derivative (flat output q; De Luca 2000). Springs without dampers.
//   tau_J   = M(q_d) a_d + C v_d + g          theta_d = q_d + tau_J / K_J
//   tau     = B theta_d'' + tau_J - K_q (theta - theta_d) - D_q (theta' - theta_d')
// theta_d'' contains tau_J'', which is differenced along the goal's motion. Goals for the joints
// from rest move along a polynomial of degree nine, which has all that; other goals are followed
// with what they have.
#include "controller/elastic/joint_springs.h"
#include "controller/impedance/chosen_damping.h"
#include "controller/laws/law.h"

namespace limber::controller {
namespace {

constexpr double kStep_s = 1e-3;

class Flatness : public Law {
 public:
  explicit Flatness(const LawArm& arm)
      : model_(arm.model),
        K_J_(JointSprings(arm.robot).at_rest()),
        D_(MatrixJ::Zero(model_.size(), model_.size())) {}

  const char* check(const Gains& gains) const noexcept override {
    return gains.settings.model_compensation == ModelCompensation::kLawDefault
               ? nullptr
               : "model_compensation: flatness has its own model torque; choose law_default";
  }

  void start(const LawInputs& in) noexcept override { design(in); }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    if (in.damping_due) design(in);
    const Goal& goal = in.goal;
    const VectorJ before = link_torque(goal, -kStep_s);
    const VectorJ now = link_torque(goal, 0.0);
    const VectorJ after = link_torque(goal, kStep_s);
    const VectorJ bend = now.cwiseQuotient(K_J_);
    const VectorJ bend_rate = ((after - before) / (2.0 * kStep_s)).cwiseQuotient(K_J_);
    const VectorJ bend_acceleration =
        ((after - 2.0 * now + before) / (kStep_s * kStep_s)).cwiseQuotient(K_J_);
    const VectorJ error = in.state.theta - goal.q_d - bend;
    out->tau_stiffness = -in.gains.K_q * error;
    out->tau_damping = -D_ * (in.state.theta_dot - goal.v_d - bend_rate);
    out->tau_feedforward = in.terms.B.cwiseProduct(goal.a_d + bend_acceleration) + now;
    out->spring_energy_J = -0.5 * error.dot(out->tau_stiffness);
  }

 private:
  // Torque on the links alone, h seconds from now.
  VectorJ link_torque(const Goal& goal, double h) noexcept {
    const VectorJ jerk = goal.smooth != nullptr ? goal.smooth->jerk : VectorJ(0.0 * goal.q_d);
    const VectorJ snap = goal.smooth != nullptr ? goal.smooth->snap : VectorJ(0.0 * goal.q_d);
    const VectorJ q =
        goal.q_d + h * (goal.v_d + h / 2.0 * (goal.a_d + h / 3.0 * (jerk + h / 4.0 * snap)));
    const VectorJ v = goal.v_d + h * (goal.a_d + h / 2.0 * (jerk + h / 3.0 * snap));
    const VectorJ a = goal.a_d + h * (jerk + h / 2.0 * snap);
    return model_.inverse_dynamics(q, v, a) - model_.rotor_inertia().cwiseProduct(a);
  }

  void design(const LawInputs& in) noexcept {
    D_ = chosen_joint_damping(in.gains, in.terms.M_total, in.gains.K_q);
  }

  ArmModel model_;
  VectorJ K_J_;
  MatrixJ D_;
};

}  // namespace

LawEntry flatness_law() {
  return {.name = "flatness",
          .summary = "follows a joint motion through the springs by feed-forward",
          .needs = sensors::kMotorEncoder | sensors::kElasticJoints,
          .goal_type = GoalType::kSmoothJoints,
          .compensation = {.gravity = false},
          .potential = Potential::kGravity,
          .make = [](const LawArm& arm) -> std::unique_ptr<Law> {
            return std::make_unique<Flatness>(arm);
          }};
}

}  // namespace limber::controller
