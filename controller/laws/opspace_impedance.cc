// Impedance at the tip with its inertia shaped by the measured wrench (Hogan 1985; Khatib 1987).
//   a   = dV_d/dt + M_d^-1 (F_ext + F_ff - A^T K_x e - D_x (V - V_d))
//   tau = J^T (Lambda (a - Jdot v) - F_ext) + C v + g + null space
//   =>  M_d (dV/dt - dV_d/dt) + D_x (V - V_d) + A^T K_x e = F_ext + F_ff
// over the rows in which K_x has an entry. M_d = M_x; if that is zero the inertia stays Lambda and
// no force is needed. D_x for (M_d, K_x), or as given. A force that comes late by t_d bounds
// how light the tip can be made against a stiff world: see docs/control_laws.md.
#include <Eigen/Cholesky>

#include "controller/impedance/damping_design.h"
#include "controller/impedance/nullspace.h"
#include "controller/laws/law.h"
#include "controller/model/pose_error.h"

namespace limber::controller {
namespace {

class OpspaceImpedance : public Law {
 public:
  explicit OpspaceImpedance(int joints) : joints_(joints) {}

  const char* check(const Gains& gains) const noexcept override {
    if (TaskRows(gains.K_x).count() > joints_) {
      return "K_x has entries in more rows than the arm has joints: it cannot shape the inertia of "
             "all of them";
    }
    return check_tip_inertia(gains);
  }

  void start(const LawInputs& in) noexcept override { D_x_ = damping(in, TaskRows(in.gains.K_x)); }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    const TaskRows rows(in.gains.K_x);
    const Matrix6 Lambda = Lambda_of(in);
    if (in.damping_due) D_x_ = damping(in, rows);
    const PoseError error = pose_error(in.terms.X_BT, in.goal.X_BD, in.gains.settings.orientation);
    const Vector6 Ke = in.gains.K_x * error.e;
    const Matrix6 gain = shaping(in, Lambda, rows);

    const Vector6 F_spring = -gain * (error.A.transpose() * Ke);
    const Vector6 F_damping = -gain * (D_x_ * (in.terms.V_BT - in.goal.V_BD));
    const Vector6 F_ext = rows.of(in.estimates.F_ext);
    const Vector6 F_other =
        gain * (F_ext + in.goal.F_ff) - F_ext + Lambda * (in.goal.A_BD - in.terms.Jdot_v);
    out->act_at_tip(in.terms.J, F_spring, F_damping, F_other);
    out->spring_energy_J = 0.5 * error.e.dot(Ke);
  }

 private:
  static Matrix6 Lambda_of(const LawInputs& in) noexcept {
    return task_inertia(in.terms, TaskRows(in.gains.K_x), in.gains.settings.lost_share);
  }

  // Lambda M_d^-1 on the task.
  static Matrix6 shaping(const LawInputs& in, const Matrix6& Lambda,
                         const TaskRows& rows) noexcept {
    if (in.gains.M_x.isZero(0.0)) return on_task(rows, Matrix6::Identity());
    return invertible_on_task(rows, in.gains.M_x).llt().solve(Lambda).transpose();
  }

  static Matrix6 damping(const LawInputs& in, const TaskRows& rows) noexcept {
    const Gains& gains = in.gains;
    const DampingDesign design = gains.settings.damping;
    if (design == DampingDesign::kGiven) return gains.D_x;
    if (gains.M_x.isZero(0.0)) {
      return tip_damping(design, task_tip(in.terms, rows), gains.K_x, gains.damping_ratio);
    }
    return inertia_damping(design, invertible_on_task(rows, gains.M_x), gains.K_x,
                           gains.damping_ratio);
  }

  int joints_;
  Matrix6 D_x_ = Matrix6::Zero();
};

}  // namespace

LawEntry opspace_impedance_law() {
  return {.name = "opspace_impedance",
          .summary = "inertia, damping and stiffness at the tip, contact wrench measured",
          .needs = sensors::kMotorEncoder,
          .goal_type = GoalType::kPose,
          .compensation = {.gravity = true, .coriolis = true, .null_space = true},
          .make = [](const LawArm& arm) -> std::unique_ptr<Law> {
            return std::make_unique<OpspaceImpedance>(arm.robot.size());
          }};
}

}  // namespace limber::controller
