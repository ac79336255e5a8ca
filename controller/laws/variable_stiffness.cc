// Two motors a joint: the springs themselves are the compliance, the motors only place them
// (Albu-Schaeffer, Fischer, Schreiber, Schoeppe, Hirzinger 2004; Migliore, Brown, DeWeerth 2005).
//   sigma: diagonal nearest to J^T K_x J + K_G(-F_ff) at the goal, compliances nearest to K_x^-1,
//   or K_q itself;  c_d: sigma(c_d) = sigma, carrying tau_d
//   e_d = q_d + x(c, tau_d),   tau_d = g(q_d) + J^T F_ff,   x: tau(c, x) = tau_d
//   tau = tau_J + T tau_J' - B (w^2 (e - e_d) + 2 w (e' - v_d))
// The spring's torque tau_J, measured, is taken off the motors, so that a load on the link does not
// move the equilibrium: the link meets sigma. A torque that comes late by t_d would feed its
// oscillation with the damping -sigma^2 t_d / (B w^2); T is three periods, more than the bus takes,
// so that the motors damp a little instead. Besides, damping is what the joints have. Stiffness
// that the springs cannot give is clipped: both have to stay taut under tau_d, and preload_max.
#include <Eigen/Cholesky>

#include "controller/elastic/pair_inverse.h"
#include "controller/elastic/vsa_stiffness.h"
#include "controller/impedance/nullspace.h"
#include "controller/impedance/stiffness_mapping.h"
#include "controller/laws/registry.h"
#include "controller/observers/filtered_difference.h"

namespace limber::controller {
namespace {

enum class StiffnessFit { kDiagonal, kCompliance, kJoint };
constexpr GainWord kFits[] = {{"diagonal", 0}, {"compliance", 1}, {"joint", 2}};
GainRow stiffness_fit = {
    .key = "stiffness_fit",
    .meaning =
        "joint stiffness from the diagonal of K_x in joint coordinates, from the compliances "
        "nearest to K_x^-1, or K_q itself",
    .words = kFits};

constexpr double kBandwidth_rad_per_s = 50.0;
constexpr double kLead_periods = 3.0;
constexpr double kInfinite_Nm_per_rad = 1e9;
constexpr double kLeastCompliance_rad_per_Nm = 1e-9;

// The task's rows alone: m x n and m x m.
struct Task {
  Task(const Matrix6J& J_all, const Matrix6& K_all) noexcept
      : J(TaskRows(K_all).count(), J_all.cols()), K(J.rows(), J.rows()) {
    const TaskRows rows(K_all);
    for (int i = 0, m = 0; i < 6; ++i) {
      if (!rows.stiff[i]) continue;
      J.row(m) = J_all.row(i);
      for (int k = 0, l = 0; k < 6; ++k) {
        if (rows.stiff[k]) K(m, l++) = K_all(i, k);
      }
      ++m;
    }
  }
  TaskJacobian J;
  TaskMatrix K;
};

class VariableStiffness : public Law {
 public:
  explicit VariableStiffness(const LawArm& arm)
      : model_(arm.model),
        torque_sensors_((sensors_of(arm.robot) & sensors::kTorqueSensor) != 0),
        link_encoders_((sensors_of(arm.robot) & sensors::kLinkEncoder) != 0),
        tau_rate_(model_.size(), kTorqueRateCorner_rad_per_s, 1.0 / arm.robot.rate_hz),
        wanted_(VectorJ::Zero(model_.size())),
        preload_(wanted_),
        sigma_(wanted_) {
    for (const JointConfig& joint : arm.robot.joints) {
      const TransmissionConfig& t = joint.transmission;
      pairs_.push_back({{t.spring}, t.damping_Nms_per_rad, t.preload_max_rad});
    }
  }

  const char* check(const Gains& gains) const noexcept override {
    if (gains.settings.model_compensation != ModelCompensation::kLawDefault) {
      return "model_compensation: variable_stiffness carries the weight by its springs; choose "
             "law_default";
    }
    if (chosen_fit(gains) != StiffnessFit::kCompliance) return nullptr;
    const Eigen::LLT<Matrix6> cholesky(invertible_on_task(TaskRows(gains.K_x), gains.K_x));
    return cholesky.info() == Eigen::Success
               ? nullptr
               : "stiffness_fit: compliance needs K_x to be positive definite where it has entries";
  }

  void start(const LawInputs& in) noexcept override {
    tau_rate_.reset();
    fit(in);
  }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    if (in.stiffness_due) fit(in);
    const VectorJ tau_d =
        model_.gravity(in.goal.q_d) + model_.jacobian(in.goal.q_d).transpose() * in.goal.F_ff;
    const double w = kBandwidth_rad_per_s;
    for (Eigen::Index i = 0; i < tau_d.size(); ++i) {
      const Pair& pair = pairs_[static_cast<std::size_t>(i)];
      const double c = in.state.preload[i];
      preload_[i] = pair_preload(pair.springs, wanted_[i], tau_d[i], pair.preload_max_rad);
      sigma_[i] =
          pair.springs.stiffness(preload_[i], pair_deflection(pair.springs, preload_[i], tau_d[i]));
      const double e_d = in.goal.q_d[i] + pair_deflection(pair.springs, c, tau_d[i]);
      out->tau_stiffness[i] = -in.terms.B[i] * w * w * (in.state.theta[i] - e_d);
      out->tau_damping[i] = -2.0 * in.terms.B[i] * w * (in.state.theta_dot[i] - in.goal.v_d[i]);
    }
    out->tau_feedforward = spring_torque_ahead(in);
  }

  const VectorJ* preload() const noexcept override { return &preload_; }

  void report(float* values) const noexcept override {
    const Eigen::Index n = sigma_.size();
    Eigen::Map<Eigen::VectorXf>(values, n) = sigma_.cast<float>();
    values[n] = static_cast<float>(residual_);
  }

 private:
  struct Pair {
    SpringPair springs;
    double damping_Nms_per_rad;
    double preload_max_rad;
  };

  static StiffnessFit chosen_fit(const Gains& gains) noexcept {
    return gains.parameters.choice<StiffnessFit>(stiffness_fit);
  }

  VectorJ spring_torque_ahead(const LawInputs& in) noexcept {
    const ArmState& s = in.state;
    const double T = kLead_periods * s.period_s;
    VectorJ tau = s.tau_measured;
    if (!link_encoders_) return tau + T * tau_rate_.update(tau);
    for (Eigen::Index i = 0; i < tau.size(); ++i) {
      const Pair& pair = pairs_[static_cast<std::size_t>(i)];
      const double bend = s.theta[i] - s.q[i];
      if (!torque_sensors_) tau[i] = pair.springs.torque(s.preload[i], bend);
      const double sigma = pair.springs.stiffness(s.preload[i], bend);
      tau[i] += (pair.damping_Nms_per_rad + T * sigma) * (s.theta_dot[i] - s.v[i]);
    }
    return tau;
  }

  void fit(const LawInputs& in) noexcept {
    residual_ = 0.0;
    if (chosen_fit(in.gains) == StiffnessFit::kJoint) {
      wanted_ = in.gains.K_q.diagonal();
      return;
    }
    const Matrix6J J = model_.jacobian(in.goal.q_d);
    const Task task(J, in.gains.K_x);
    if (task.J.rows() == 0) {
      wanted_.setZero();
      return;
    }
    const bool diagonal = chosen_fit(in.gains) == StiffnessFit::kDiagonal;
    const MatrixJ K_G = geometric_term(J, -in.goal.F_ff);
    const JointFit found = diagonal ? nearest_joint_stiffness(task.J, task.K, K_G)
                                    : nearest_joint_compliance(task.J, task.K);
    residual_ = found.residual;
    wanted_ = found.value;
    if (!diagonal) {
      wanted_ = found.value.cwiseMax(kLeastCompliance_rad_per_Nm).cwiseInverse();
    }
    wanted_ = wanted_.cwiseMin(kInfinite_Nm_per_rad);
  }

  ArmModel model_;
  bool torque_sensors_;
  bool link_encoders_;
  FilteredDifference<VectorJ> tau_rate_;
  std::vector<Pair> pairs_;
  VectorJ wanted_;
  VectorJ preload_;
  VectorJ sigma_;
  double residual_ = 0.0;
};

}  // namespace

LawEntry variable_stiffness_law() {
  return {.name = "variable_stiffness",
          .summary = "two motors a joint set the springs' stiffness",
          .needs = sensors::kMotorEncoder | sensors::kTwoMotors | sensors::kDeflection,
          .goal_type = GoalType::kJointsAndWrench,
          .compensation = {.gravity = false},
          .potential = Potential::kGravity,
          .parameters = {&stiffness_fit},
          .reports = {{"sigma", "N m/rad", "joint stiffness set on the springs", true},
                      {"fit_residual", "1", "share of the wanted tip stiffness that they miss"}},
          .make = [](const LawArm& arm) -> std::unique_ptr<Law> {
            return std::make_unique<VariableStiffness>(arm);
          }};
}

}  // namespace limber::controller
