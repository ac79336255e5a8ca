// Motor position control with constant gravity compensation (P. Tomei 1991); needs no sensor but
// the motors' encoders.
//   tau = g(q_d) - K_q (theta - theta_d) - D_q theta',   theta_d = q_d + K_J^-1 g(q_d)
// The link comes to rest at q_d from anywhere if lambda_min [K_J, -K_J; -K_J, K_J + K_q] exceeds
// the greatest |dg/dq| of the arm; gains that do not are refused. The link meets the springs and
// K_q in series, less the weight's gradient.
#include "controller/elastic/tomei.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>
#include <string>

#include "controller/elastic/joint_springs.h"
#include "controller/impedance/chosen_damping.h"
#include "controller/laws/law.h"

namespace limber::controller {
namespace {

constexpr int kPostures = 500;
constexpr unsigned kSeed = 1;

// Greatest norm of dg/dq over postures within the joint limits, N m/rad.
double steepest_weight(const Robot& robot, ArmModel* model) {
  std::mt19937 generator(kSeed);
  double alpha = 0.0;
  VectorJ q(robot.size());
  for (int i = 0; i < kPostures; ++i) {
    for (int j = 0; j < robot.size(); ++j) {
      const JointConfig& joint = robot.joints[static_cast<std::size_t>(j)];
      const bool limited = std::isfinite(joint.position_min) && std::isfinite(joint.position_max);
      q[j] = std::uniform_real_distribution<double>(
          limited ? joint.position_min : -EIGEN_PI,
          limited ? joint.position_max : EIGEN_PI)(generator);
    }
    const MatrixJ slope = model->gravity_gradient(q);
    alpha = std::max(alpha, Eigen::SelfAdjointEigenSolver<MatrixJ>(slope, Eigen::EigenvaluesOnly)
                                .eigenvalues()
                                .cwiseAbs()
                                .maxCoeff());
  }
  return alpha;
}

class TomeiLaw : public Law {
 public:
  explicit TomeiLaw(const LawArm& arm)
      : model_(arm.model), alpha_(steepest_weight(arm.robot, &model_)) {
    const Eigen::Index n = model_.size();
    law_ = {MatrixJ::Zero(n, n), MatrixJ::Zero(n, n), JointSprings(arm.robot).at_rest()};
    refusal_ =
        "K_q is too soft for constant gravity compensation: the smallest eigenvalue of "
        "[K_J, -K_J; -K_J, K_J + K_q] must exceed " +
        std::to_string(alpha_) + " N m/rad, by which this arm's weight changes at most";
  }

  const char* check(const Gains& gains) const noexcept override {
    if (gains.settings.model_compensation != ModelCompensation::kLawDefault) {
      return "model_compensation: tomei has its own gravity torque; choose law_default";
    }
    const Tomei wanted{gains.K_q, law_.K_D, law_.K_J};
    return wanted.lambda_min() > alpha_ ? nullptr : refusal_.c_str();
  }

  void start(const LawInputs& in) noexcept override { design(in); }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    if (in.damping_due) design(in);
    law_.K_P = in.gains.K_q;
    const VectorJ g_d = model_.gravity(in.goal.q_d);
    const VectorJ error = in.state.theta - law_.theta_d(in.goal.q_d, g_d);
    out->tau_stiffness = -law_.K_P * error;
    out->tau_damping = -law_.K_D * in.state.theta_dot;
    out->tau_feedforward = g_d;
    out->spring_energy_J = -0.5 * error.dot(out->tau_stiffness);
  }

 private:
  void design(const LawInputs& in) noexcept {
    law_.K_D = chosen_joint_damping(in.gains, in.terms.M_total, in.gains.K_q);
  }

  ArmModel model_;
  double alpha_;
  Tomei law_;
  std::string refusal_;
};

}  // namespace

LawEntry tomei_law() {
  return {.name = "tomei",
          .summary = "motor position control, weight of the goal's posture",
          .needs = sensors::kMotorEncoder | sensors::kElasticJoints,
          .goal_type = GoalType::kJoints,
          .compensation = {.gravity = false},
          .potential = Potential::kGravity,
          .make = [](const LawArm& arm) -> std::unique_ptr<Law> {
            return std::make_unique<TomeiLaw>(arm);
          }};
}

}  // namespace limber::controller
