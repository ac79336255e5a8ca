// The motor law that steers the springs' deflection to zero, as one finds it printed.
//   tau = -K_q (theta - q) - D_q (theta' - v)
// It has no set-point and no stiffness at the link, which moves with M + B / (1 + K_q / K_J) and
// falls under its weight: torque feedback around nothing. D_q for (B, K_q), or as given. q by the
// link encoders, or from the torque sensors' K_J^-1 tau_J.
#include "controller/elastic/joint_springs.h"
#include "controller/impedance/chosen_damping.h"
#include "controller/laws/registry.h"
#include "controller/observers/filtered_difference.h"

namespace limber::controller {
namespace {

class DeflectionPd : public Law {
 public:
  explicit DeflectionPd(const LawArm& arm)
      : link_encoders_((sensors_of(arm.robot) & sensors::kLinkEncoder) != 0),
        K_J_(JointSprings(arm.robot).at_rest()),
        bend_rate_(arm.robot.size(), kTorqueRateCorner_rad_per_s, 1.0 / arm.robot.rate_hz) {}

  void start(const LawInputs& /*in*/) noexcept override { bend_rate_.reset(); }

  void compute(const LawInputs& in, LawOutput* out) noexcept override {
    const MatrixJ B = in.terms.B.asDiagonal();
    const MatrixJ D = chosen_joint_damping(in.gains, B, in.gains.K_q);
    const ArmState& s = in.state;
    VectorJ bend = s.theta - s.q;
    VectorJ rate = s.theta_dot - s.v;
    if (!link_encoders_) {
      bend = s.tau_measured.cwiseQuotient(K_J_);
      rate = bend_rate_.update(bend);
    }
    out->tau_stiffness = -in.gains.K_q * bend;
    out->tau_damping = -D * rate;
  }

 private:
  bool link_encoders_;
  VectorJ K_J_;
  FilteredDifference<VectorJ> bend_rate_;
};

}  // namespace

LawEntry deflection_pd_law() {
  return {.name = "deflection_pd",
          .summary = "steers the springs' deflection to zero; for demonstration, carries nothing",
          .needs = sensors::kMotorEncoder | sensors::kElasticJoints | sensors::kDeflection,
          .goal_type = GoalType::kNone,
          .compensation = {.gravity = false},
          .demonstration = true,
          .make = [](const LawArm& arm) -> std::unique_ptr<Law> {
            return std::make_unique<DeflectionPd>(arm);
          }};
}

}  // namespace limber::controller
