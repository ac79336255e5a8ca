// A spring and a damper between tip and goal, without shaping the inertia (Hogan 1985).
//   F   = -h A^T K_x e - D_x (V - V_d) + F_ff,   tau = J^T F + g + C v + null space
//   tip:  Lambda (dV/dt - Jdot v) + D_x (V - V_d) + h A^T K_x e = F_ext + F_ff
// With `inertia_feedforward` J^T Lambda (dV_d/dt - Jdot v) is added: a moving goal is then followed
// without lag. A is the error-rate matrix, without which a spring with unequal rotational stiffness
// would feed energy in. D_x by the damping design from (Lambda with rotors, K_x), plus a floor
// where K_x is zero; or as given. h <= 1 limits the spring's force, see spring_limit.h. Rows of K_x
// may be zero: the tip is then free in that direction, and the null space gains it; with F_ff along
// such a row this is hybrid control of force and impedance, without force feedback.
#include <limber/controller_status_t.hpp>

#include "controller/impedance/chosen_damping.h"
#include "controller/impedance/damping_design.h"
#include "controller/impedance/nullspace.h"
#include "controller/laws/law.h"
#include "controller/model/pose_error.h"
#include "controller/model/spring_limit.h"

namespace limber::controller {
namespace {

GainRow inertia_feedforward = {.key = "inertia_feedforward",
                               .meaning = "feeds the inertia torque of the moving goal forward",
                               .words = switch_words()};

class CartesianImpedance : public Law {
 public:
  void start(const LawInputs& in) noexcept override {
    read_stiffness(in.gains);
    D_x_ = chosen_tip_damping(in.gains, in.terms, in.elastic);
  }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    if (in.gains.K_x != K_x_ || force_N_ != in.gains.settings.spring_force_N ||
        moment_Nm_ != in.gains.settings.spring_moment_Nm) {
      read_stiffness(in.gains);
    }
    if (in.damping_due) D_x_ = chosen_tip_damping(in.gains, in.terms, in.elastic);
    const PoseError error = pose_error(in.terms.X_BT, in.goal.X_BD, in.gains.settings.orientation);

    const Vector6 Ke = K_x_ * error.e;
    const LimitedSpring spring = limit_.apply(0.5 * error.e.dot(Ke));
    const Vector6 F_spring = -spring.scale * (error.A.transpose() * Ke);
    const Vector6 F_damping = -damping(in.gains) * (in.terms.V_BT - in.goal.V_BD);

    const Vector6 F_other = in.goal.F_ff + inertia_force(in);
    out->act_at_tip(in.terms.J, F_spring, F_damping, F_other);
    out->spring_energy_J = spring.energy_J;
    if (spring.scale < 1.0) out->limits |= controller_status_t::LIMIT_SPRING;
  }

 private:
  void read_stiffness(const Gains& gains) noexcept {
    K_x_ = gains.K_x;
    floor_ = tip_damping_floor(K_x_);
    force_N_ = gains.settings.spring_force_N;
    moment_Nm_ = gains.settings.spring_moment_Nm;
    limit_ = SpringLimit(K_x_, force_N_, moment_Nm_);
  }

  Matrix6 damping(const Gains& gains) const noexcept {
    if (gains.settings.damping == DampingDesign::kGiven) return D_x_;
    return D_x_ + floor_;
  }

  static Vector6 inertia_force(const LawInputs& in) noexcept {
    if (!in.gains.parameters.on(inertia_feedforward)) return Vector6::Zero();
    const Matrix6 Lambda =
        task_inertia(in.terms, TaskRows(in.gains.K_x), in.gains.settings.lost_share);
    return Lambda * (in.goal.A_BD - in.terms.Jdot_v);
  }

  Matrix6 K_x_ = Matrix6::Zero();
  Matrix6 D_x_ = Matrix6::Zero();
  Matrix6 floor_ = Matrix6::Zero();
  double force_N_ = 0.0;
  double moment_Nm_ = 0.0;
  SpringLimit limit_{Matrix6::Zero(), 0.0, 0.0};
};

}  // namespace

LawEntry cartesian_impedance_law() {
  return {.name = "cartesian_impedance",
          .summary = "spring and damper between the tip and its goal",
          .needs = sensors::kMotorEncoder,
          .goal_type = GoalType::kPose,
          .compensation = {.gravity = true, .coriolis = true, .null_space = true},
          .potential = Potential::kTipSpring,
          .damped = DampedAt::kTip,
          .parameters = {&inertia_feedforward},
          .make = [](const LawArm&) -> std::unique_ptr<Law> {
            return std::make_unique<CartesianImpedance>();
          }};
}

}  // namespace limber::controller
