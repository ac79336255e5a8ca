// Admittance: a virtual mass, spring and damper moves the goal of a stiff position loop (Hogan
// 1985; Lawrence 1988). The dual of impedance: position in, force felt.
//   outer  M_x dv_c + D_x v_c + K_x x_c = F_ext + F_ff       (implicit step, see AdmittanceFilter)
//   inner  q_c from the commanded pose X_BD (+) x_c, then
//          tau = -K_q (q - q_c) - D_q (v - v_c) + g + C v
// K_q must be stiff against K_x for the outer loop to be what is felt. M_x: as given, or the tip's
// inertia where the law started. D_x for (M_x, K_x), or as given. Without delay and without K_x and
// D_x this is stable only if M_x is heavier than the arm; a stiff contact raises the least K_x: see
// docs/control_laws.md.
#include "controller/goals/inverse_kinematics.h"
#include "controller/impedance/chosen_damping.h"
#include "controller/impedance/damping_design.h"
#include "controller/impedance/nullspace.h"
#include "controller/laws/law.h"
#include "controller/observers/admittance_filter.h"

namespace limber::controller {
namespace {

class Admittance : public Law {
 public:
  explicit Admittance(const LawArm& arm)
      : joints_(arm.robot.size()),
        goal_(joints_),
        inverse_kinematics_(arm.model),
        filter_(Matrix6::Identity(), Matrix6::Zero(), Matrix6::Zero(), 1.0 / arm.robot.rate_hz),
        D_q_(MatrixJ::Zero(joints_, joints_)) {}

  const char* check(const Gains& gains) const noexcept override {
    if (TaskRows(gains.K_x).count() > joints_) {
      return "K_x has entries in more rows than the arm has joints to follow them with";
    }
    if (gains.settings.contact == ContactSource::kNone) {
      return "admittance needs a contact source: contact is none";
    }
    return check_tip_inertia(gains);
  }

  void start(const LawInputs& in) noexcept override {
    filter_.reset();
    inverse_kinematics_.reset(in.point.q);
    M_start_ = task_inertia(in.terms, TaskRows(in.gains.K_x));
    design(in);
  }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    if (in.damping_due) design(in);
    const TaskRows rows(in.gains.K_x);
    const Vector6 F = rows.of(Vector6(in.estimates.F_ext + in.goal.F_ff));
    filter_.update(F);
    const CompliantPose commanded = compose(in.goal.X_BD, in.goal.V_BD, filter_.x(), filter_.v());
    goal_.X_BD = commanded.X_BC;
    goal_.V_BD = commanded.V_BC;
    goal_.q_null = in.goal.q_null;
    inverse_kinematics_.track(rows, in.dt_s, &goal_);

    const VectorJ error = in.point.q - goal_.q_d;
    out->F = out->F_other = in.goal.F_ff;  // the position loop acts at the joints
    out->tau_stiffness = -in.gains.K_q * error;
    out->tau_damping = -D_q_ * (in.point.v - goal_.v_d);
    out->spring_energy_J = -0.5 * error.dot(out->tau_stiffness);
  }

 private:
  void design(const LawInputs& in) noexcept {
    const TaskRows rows(in.gains.K_x);
    const Matrix6& wanted = in.gains.M_x.isZero(0.0) ? M_start_ : in.gains.M_x;
    const Matrix6 M = invertible_on_task(rows, wanted);
    const DampingDesign design = in.gains.settings.damping;
    const bool given = design == DampingDesign::kGiven;
    const Matrix6 D =
        given ? in.gains.D_x : inertia_damping(design, M, in.gains.K_x, in.gains.damping_ratio);
    filter_.set(M, D, in.gains.K_x);
    D_q_ = chosen_joint_damping(in.gains, in.terms.M_total, in.gains.K_q);
  }

  int joints_;
  Goal goal_;  // what the inner loop follows
  InverseKinematics inverse_kinematics_;
  AdmittanceFilter filter_;
  Matrix6 M_start_ = Matrix6::Identity();
  MatrixJ D_q_;
};

}  // namespace

LawEntry admittance_law() {
  return {.name = "admittance",
          .summary = "virtual mass, spring and damper around a stiff position loop",
          .needs = sensors::kMotorEncoder,
          .goal_type = GoalType::kPose,
          .compensation = {.gravity = true, .coriolis = true},
          .make = [](const LawArm& arm) -> std::unique_ptr<Law> {
            return std::make_unique<Admittance>(arm);
          }};
}

}  // namespace limber::controller
