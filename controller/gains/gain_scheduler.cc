#include "controller/gains/gain_scheduler.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/config_error.h"
#include "controller/gains/read_gains.h"
#include "controller/model/pose_error.h"

namespace limber::controller {
namespace {

// Of what the damper takes out, this much goes into the tank.
constexpr double kTankShare = 0.9;
constexpr double kSlowest = 1e-12;  // m^2/s^2

void check_joint_springs(const Robot& robot, const MatrixJ& K_q, const JointSprings& springs) {
  for (int i = 0; i < robot.size(); ++i) {
    const double most = JointSprings::kHighestShare * springs.at_rest()[i];
    if (K_q(i, i) <= most) continue;
    throw ConfigError(fmt::format(
        "{}: gains: K_q of joint {} is {:f} N m/rad; its spring allows at most {:f}, 0.9 times its "
        "own stiffness",
        robot.name, robot.joints[static_cast<std::size_t>(i)].name, K_q(i, i), most));
  }
}

// Of the weight that a law carries with these settings.
MatrixJ carried_gradient(const LawEntry& law, const LawSettings& settings,
                         const ArmView& arm) noexcept {
  const MatrixJ& gradient = arm.gravity_gradient();
  const bool carried = chosen_compensation(law.compensation, settings.model_compensation).gravity;
  return carried ? gradient : MatrixJ(MatrixJ::Zero(gradient.rows(), gradient.cols()));
}

MatrixJ at_joints(const Matrix6& K_x, const ArmView& arm) noexcept {
  return arm.terms().J.transpose() * K_x * arm.terms().J;
}

}  // namespace

GainScheduler::GainScheduler(const Robot& robot, const JointSprings& springs, LawRows rows)
    : springs_check_(robot),
      ramp_(default_gains(robot, rows)),
      effective_(ramp_.now()),
      tank_({0.0, 0.0, 0.0, 0.0}, ramp_.now().K_x) {
  check_joint_springs(robot, ramp_.now().K_q, springs);
}

bool GainScheduler::start(const Gains& requested, double ramp_s) noexcept {
  const Gains& now = ramp_.now();
  const double tank_J = requested.settings.tank_J;
  if (tank_J != now.settings.tank_J) {
    tank_ = EnergyTank({tank_J, 0.0, tank_J, kTankShare}, effective_.K_x);
  }
  const bool switched = requested.settings != now.settings || requested.M_x != now.M_x ||
                        requested.parameters.jumps_from(now.parameters);
  ramp_.start(requested, ramp_s);
  changed_ = true;
  scale_end_ = 1.0;
  return switched;
}

const Gains& GainScheduler::update(const Goal& goal, const LawEntry& law, bool holding,
                                   const ArmView& arm, double period_s) noexcept {
  take_ramped();
  if (holding) effective_.settings = default_settings();
  if (!holding && scale_ != 1.0) {
    effective_.K_x *= scale_;
    effective_.K_q *= scale_;
  }
  turn_to_base(goal.X_BD.Q.toRotationMatrix(), &effective_);
  reduce_to_springs(law, holding, arm);
  if (effective_.settings.tank_J > 0.0) draw_from_tank(goal, arm, period_s);
  return effective_;
}

// While the ramp rests only what update() changes: the laws' parameters are many.
void GainScheduler::take_ramped() noexcept {
  const Gains& now = ramp_.now();
  if (changed_) effective_ = now;
  changed_ = false;
  effective_.settings = now.settings;
  effective_.K_x = now.K_x;
  effective_.D_x = now.D_x;
  effective_.M_x = now.M_x;
  effective_.K_q = now.K_q;
}

PositionFeedback GainScheduler::position(const LawEntry& law, bool holding,
                                         const ArmView& arm) const noexcept {
  return arm.resolve(holding ? PositionFeedback::kAuto : settings().position_feedback,
                     law.potential);
}

// In another pose, or with less preload, than where the gains were requested.
void GainScheduler::reduce_to_springs(const LawEntry& law, bool holding,
                                      const ArmView& arm) noexcept {
  reduced_ = false;
  if (!arm.springs().any() || position(law, holding, arm) == PositionFeedback::kMotor) return;
  const MatrixJ weight = carried_gradient(law, effective_.settings, arm);
  if (law.potential == Potential::kJointSpring) {
    effective_.K_q = JointSprings::within(effective_.K_q, arm.K_J(), weight);
  }
  if (law.potential != Potential::kTipSpring) return;
  const double share =
      JointSprings::allowed_share(at_joints(effective_.K_x, arm), arm.K_J(), weight);
  effective_.K_x *= share;
  reduced_ = share < 1.0;
}

// A stiffer spring takes its energy from the tank, which the damper of the last cycle has filled.
void GainScheduler::draw_from_tank(const Goal& goal, const ArmView& arm, double period_s) noexcept {
  const ArmTerms& terms = arm.terms();
  const PoseError error = pose_error(terms.X_BT, goal.X_BD, effective_.settings.orientation);
  const Vector6 V = terms.V_BT - goal.V_BD;
  // As a matrix that dissipates just that along V.
  const Matrix6 D = last_dissipated_W_ / std::max(V.squaredNorm(), kSlowest) * Matrix6::Identity();
  last_dissipated_W_ = 0.0;
  effective_.K_x = tank_.update(effective_.K_x, D, error.e, V, period_s);
}

Gains GainScheduler::here(const Gains& gains, const LawEntry& law, const Goal& goal,
                          const ArmView& arm) const noexcept {
  Gains here = gains;
  turn_to_base(goal.X_BD.Q.toRotationMatrix(), &here);
  if (arm.resolve(gains.settings.position_feedback, law.potential) != PositionFeedback::kMotor) {
    const VectorJ& K_J = arm.springs().at_rest();
    const MatrixJ weight = carried_gradient(law, gains.settings, arm);
    here.K_q = JointSprings::within(here.K_q, K_J, weight);
    here.K_x *= JointSprings::allowed_share(at_joints(here.K_x, arm), K_J, weight);
  }
  return here;
}

const char* GainScheduler::check_springs(const Gains& gains, const LawEntry& law, const Goal& goal,
                                         const ArmView& arm) noexcept {
  const bool joints = law.potential == Potential::kJointSpring;
  if (!arm.springs().any() || (!joints && law.potential != Potential::kTipSpring)) return nullptr;
  if (arm.resolve(gains.settings.position_feedback, law.potential) == PositionFeedback::kMotor) {
    return nullptr;
  }
  Gains here = gains;
  turn_to_base(goal.X_BD.Q.toRotationMatrix(), &here);
  return springs_check_.check(joints ? "K_q" : "K_x", joints ? here.K_q : at_joints(here.K_x, arm),
                              arm.springs().at_rest(), carried_gradient(law, gains.settings, arm));
}

}  // namespace limber::controller
