// Cartesian impedance with acceleration feedback: changes the inertia a hand feels by M_x.
//   F = -A^T K_x e - D_x V - M_x dV/dt,   tau = J^T F + C v + g + null space
//   tip:  (Lambda + M_x) dV/dt - Lambda Jdot v + D_x V + A^T K_x e = F_ext
// dV/dt is the filtered difference of the tip's twist (see Estimates). M_x adds to Lambda, it does
// not replace it. Sampled at T with a filter p = exp(-T / tau_a), a mass m allows
// -m < M_x < m (1 + p) / (1 - p), about 2 m tau_a / T. D_x as for cartesian_impedance,
// without the floor.
#include "controller/impedance/chosen_damping.h"
#include "controller/impedance/damping_design.h"
#include "controller/laws/law.h"
#include "controller/model/pose_error.h"

namespace limber::controller {
namespace {

class AccelFeedback : public Law {
 public:
  void start(const LawInputs& in) noexcept override {
    D_x_ = chosen_tip_damping(in.gains, in.terms);
  }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    if (in.damping_due) D_x_ = chosen_tip_damping(in.gains, in.terms);
    const PoseError error = pose_error(in.terms.X_BT, in.goal.X_BD, in.gains.settings.orientation);
    const Vector6 Ke = in.gains.K_x * error.e;
    const Vector6 F_spring = -error.A.transpose() * Ke;
    const Vector6 F_damping = -D_x_ * (in.terms.V_BT - in.goal.V_BD);
    const Vector6 F_other = in.goal.F_ff - in.gains.M_x * in.estimates.A_BT;
    out->act_at_tip(in.terms.J, F_spring, F_damping, F_other);
    out->spring_energy_J = 0.5 * error.e.dot(Ke);
  }

 private:
  Matrix6 D_x_ = Matrix6::Zero();
};

}  // namespace

LawEntry accel_feedback_law() {
  return {.name = "accel_feedback",
          .summary = "Cartesian impedance with an inertia added by acceleration feedback",
          .needs = sensors::kMotorEncoder,
          .goal_type = GoalType::kPose,
          .compensation = {.gravity = true, .coriolis = true, .null_space = true},
          .make = [](const LawArm&) -> std::unique_ptr<Law> {
            return std::make_unique<AccelFeedback>();
          }};
}

}  // namespace limber::controller
