// Cartesian impedance mapped to joint gains at a pose, times the finite joint error (lecture
// equation 7).
//   tau = K_p (q_d - q) + K_v (s v_d - v) + g,   s = 1 with `follow_velocity`, else 0
//   K_v = J^T D_x J at the present pose
// K_p by `stiffness_terms` at `stiffness_pose`; q_d from inverse kinematics where the goal is at
// the tip. A tangent used as a secant: against -J^T A^T K_x e the torque is off in first order of
// the deviation, except at the mid pose with the full tangent, or the mean of both ends, where it
// is second order better and conservative; cartesian_impedance is exact. `damping_partials` shows
// what the derivative of the damping torque does, in the stiffness, where it belongs, or in the
// damping, as one finds it printed.
#include "controller/impedance/chosen_damping.h"
#include "controller/impedance/stiffness_mapping.h"
#include "controller/laws/law.h"

namespace limber::controller {
namespace {

constexpr GainWord kPoses[] = {{"current", static_cast<int>(MappingPose::kCurrent)},
                               {"goal", static_cast<int>(MappingPose::kGoal)},
                               {"mid", static_cast<int>(MappingPose::kMid)},
                               {"mean", static_cast<int>(MappingPose::kMean)}};
GainRow stiffness_pose = {.key = "stiffness_pose",
                          .meaning = "pose at which the joint stiffness is evaluated",
                          .standard = static_cast<int>(MappingPose::kMid),
                          .words = kPoses};
constexpr GainWord kPartials[] = {{"none", static_cast<int>(DampingPartials::kNone)},
                                  {"in_stiffness", static_cast<int>(DampingPartials::kInStiffness)},
                                  {"printed", static_cast<int>(DampingPartials::kPrinted), true}};
GainRow damping_partials = {
    .key = "damping_partials",
    .meaning =
        "where the derivative of the damping torque goes: nowhere, into the stiffness, or, a "
        "demonstration, into the damping as printed",
    .words = kPartials};
GainRow follow_velocity = {.key = "follow_velocity",
                           .meaning = "damps against the goal's velocity instead of standstill",
                           .standard = 1.0,
                           .words = switch_words()};

class MappedJointImpedance : public Law {
 public:
  explicit MappedJointImpedance(const LawArm& arm)
      : model_(arm.model), K_p_(MatrixJ::Zero(model_.size(), model_.size())), K_v_(K_p_) {}

  void start(const LawInputs& in) noexcept override { map(in); }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    if (in.stiffness_due || in.damping_due) map(in);
    out->tau_stiffness = K_p_ * (in.goal.q_d - in.point.q);
    out->tau_damping = -K_v_ * in.point.v;
    if (in.gains.parameters.on(follow_velocity)) out->tau_damping += K_v_ * in.goal.v_d;
    out->tau_feedforward = in.terms.J.transpose() * in.goal.F_ff;
  }

 private:
  void map(const LawInputs& in) noexcept {
    const LawParameters& own = in.gains.parameters;
    const MappingChoice choice{own.choice<MappingPose>(stiffness_pose),
                               own.choice<DampingPartials>(damping_partials)};
    const MappedGains mapped =
        mapped_gains(&model_, in.point.q, in.point.v, in.goal, in.gains,
                     chosen_tip_damping(in.gains, in.terms, in.elastic), choice);
    if (in.stiffness_due) K_p_ = mapped.K_p;
    if (in.damping_due) K_v_ = mapped.K_v;
  }

  ArmModel model_;
  MatrixJ K_p_;
  MatrixJ K_v_;
};

}  // namespace

LawEntry mapped_joint_impedance_law() {
  return {
      .name = "mapped_joint_impedance",
      .summary = "Cartesian impedance as joint gains times the finite joint error (lecture eq. 7)",
      .needs = sensors::kMotorEncoder,
      .goal_type = GoalType::kJointsAndWrench,
      .compensation = {.gravity = true, .null_space = true},
      .damped = DampedAt::kTip,
      .parameters = {&stiffness_pose, &damping_partials, &follow_velocity},
      .make = [](const LawArm& arm) -> std::unique_ptr<Law> {
        return std::make_unique<MappedJointImpedance>(arm);
      }};
}

}  // namespace limber::controller
