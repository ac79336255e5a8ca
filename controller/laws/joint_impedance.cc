// Impedance at the joints with the contact torque measured (Hogan 1985, in joint space).
//   a   = a_d + M_d^-1 (tau_ext - K_q (q - q_d) - D_q (v - v_d))
//   tau = M a + C v + g - tau_ext
//   =>  M_d (dv/dt - a_d) + D_q (v - v_d) + K_q (q - q_d) = tau_ext
// as long as tau_ext is right: from the joints' torques it sees a contact anywhere, from a sensor
// at the tip only there. A contact it does not see meets the stiffness M M_d^-1 K_q instead.
// M_d as given, or the diagonal of M where the law started; D_q for (M_d, K_q), or as given.
#include <Eigen/Cholesky>

#include "controller/impedance/chosen_damping.h"
#include "controller/laws/law.h"

namespace limber::controller {
namespace {

GainRow M_q = {
    .key = "M_q_kgm2",
    .meaning = "inertia of the joints; 0: the diagonal of the arm's own where the law started",
    .unit = "kg m²",
    .high = 1e2,
    .per_joint = true};

class JointImpedance : public Law {
 public:
  explicit JointImpedance(int joints)
      : M_start_(MatrixJ::Identity(joints, joints)),
        M_d_(M_start_),
        cholesky_(M_d_),
        D_(M_start_),
        kept_(joints) {}

  const char* check(const Gains& gains) const noexcept override {
    const MatrixJ& M = gains.parameters.matrix(M_q);
    if (M.isZero(0.0)) return nullptr;
    return Eigen::LLT<MatrixJ>(M).info() == Eigen::Success
               ? nullptr
               : "M_q_kgm2 must be positive for every joint";
  }

  void start(const LawInputs& in) noexcept override {
    M_start_ = in.terms.M_total.diagonal().asDiagonal();
    design(in);
  }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    if (in.damping_due) design(in);
    if (wanted(in.gains) != M_d_) decompose(wanted(in.gains));
    const auto torque = [&](const VectorJ& effort) -> VectorJ {
      return in.terms.M_total * cholesky_.solve(effort);
    };
    out->tau_stiffness = torque(-in.gains.K_q * (in.point.q - in.goal.q_d));
    out->tau_damping = torque(-D_ * (in.point.v - in.goal.v_d));
    const VectorJ& tau_ext = in.estimates.tau_ext;
    out->tau_feedforward = in.terms.M_total * in.goal.a_d + torque(tau_ext) - tau_ext;
  }

 private:
  MatrixJ wanted(const Gains& gains) const noexcept {
    const MatrixJ& M = gains.parameters.matrix(M_q);
    return M.isZero(0.0) ? M_start_ : M;
  }

  void decompose(const MatrixJ& M_d) noexcept {
    M_d_ = M_d;
    cholesky_.compute(M_d_);
  }

  void design(const LawInputs& in) noexcept {
    D_ = kept_.of(in.gains, wanted(in.gains), in.gains.K_q);
  }

  MatrixJ M_start_;
  MatrixJ M_d_;
  Eigen::LLT<MatrixJ> cholesky_;  // of M_d_
  MatrixJ D_;
  KeptJointDamping kept_;
};

}  // namespace

LawEntry joint_impedance_law() {
  return {.name = "joint_impedance",
          .summary = "joint inertia, damping and stiffness, contact torque measured",
          .needs = sensors::kMotorEncoder,
          .goal_type = GoalType::kJoints,
          .compensation = {.gravity = true, .coriolis = true},
          .parameters = {&M_q},
          .make = [](const LawArm& arm) -> std::unique_ptr<Law> {
            return std::make_unique<JointImpedance>(arm.robot.size());
          }};
}

}  // namespace limber::controller
