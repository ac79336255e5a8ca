#include "controller/torque_cycle.h"

#include <algorithm>

#include "common/config_error.h"
#include "controller/pose_error.h"
#include "controller/singularity.h"

namespace limber::controller {
namespace {

// The posture may take this share of a joint's torque.
constexpr double kNullShare = 0.3;
// Of what the damper takes out, this much goes into the tank.
constexpr double kTankShare = 0.9;
constexpr double kSlowest = 1e-12;  // m^2/s^2

int checked_law(const std::string& name, unsigned sensors) {
  const int index = find_law(name);
  if (index < 0) {
    std::string all;
    for (const LawEntry& entry : laws()) all += (all.empty() ? "" : ", ") + std::string(entry.name);
    throw ConfigError("no control law is called '" + name + "'; there are " + all);
  }
  const LawEntry& entry = laws()[static_cast<std::size_t>(index)];
  if (const char* reason = refuse_law(entry, sensors)) throw ConfigError(name + ": " + reason);
  return index;
}

void check_joint_springs(const Robot& robot, const MatrixJ& K_q, const JointSprings& springs) {
  for (int i = 0; i < robot.size(); ++i) {
    const double most = JointSprings::kHighestShare * springs.at_rest()[i];
    if (K_q(i, i) <= most) continue;
    throw ConfigError(robot.name + ": gains: K_q of joint " +
                      robot.joints[static_cast<std::size_t>(i)].name + " is " +
                      std::to_string(K_q(i, i)) + " N m/rad; its spring allows at most " +
                      std::to_string(most) + ", " + "0.9 times its own stiffness");
  }
}

}  // namespace

TorqueCycle::TorqueCycle(const LoadedRobot& robot, const std::string& law)
    : model_(robot),
      state_(model_.size()),
      seen_(model_.size()),
      terms_(model_.size()),
      sensors_(sensors_of(robot.robot)),
      side_(robot.robot, &model_),
      hold_(checked_law("joint_pd", sensors_)),
      selected_(checked_law(law, sensors_)),
      running_(hold_),
      goals_(robot.robot),
      goal_(model_.size()),
      inverse_kinematics_(robot),
      gains_(default_gains(robot.robot)),
      active_(gains_.now()),
      asked_(gains_.now()),
      estimation_(robot),
      tank_({0.0, 0.0, 0.0, 0.0}, gains_.now().K_x),
      passivity_(3, 0.0),
      rows_(gains_.now().K_x),
      blend_(model_.size()),
      limits_(robot.robot),
      preload_(robot.robot),
      null_limit_(kNullShare * limits_.torque_limit()),
      none_(VectorJ::Zero(model_.size())),
      law_(model_.size()),
      tau_null_(none_),
      tau_gravity_(none_),
      tau_coriolis_(none_),
      tau_friction_(none_),
      gravity_(none_) {
  check_joint_springs(robot.robot, gains_.now().K_q, side_.springs());
  for (const LawEntry& entry : laws()) {
    const bool possible = refuse_law(entry, sensors_) == nullptr;
    laws_.push_back(possible ? entry.make(robot) : nullptr);
  }
  if (const char* reason = laws_[static_cast<std::size_t>(selected_)]->refuse(gains_.now())) {
    throw ConfigError(robot.robot.name + ": " + law + ": " + reason);
  }
}

bool TorqueCycle::due(Term term) const noexcept {
  return cycles_ % gains_.now().settings.period_cycles[static_cast<std::size_t>(term)] == 0;
}

LawInputs TorqueCycle::inputs(double dt_s) const noexcept {
  return {.state = seen_,
          .measured = state_,
          .terms = terms_,
          .goal = goal_,
          .gains = active_,
          .estimates = estimation_.estimates(),
          .dt_s = dt_s,
          .stiffness_due = due(Term::kStiffness),
          .damping_due = due(Term::kDamping)};
}

void TorqueCycle::measure(const joint_state_t& message) noexcept {
  ++cycles_;
  read_arm_state(message, &state_);
  estimation_.estimate_velocity(&state_);
  look(resting_ ? StaticForm::kGravity : entry().statics);
  estimation_.observe(message, state_, terms_, TaskRows(active_.K_x), &model_);
  if (!terms_.g.allFinite()) return;
  gravity_ = terms_.g.cwiseMax(-limits_.torque_limit()).cwiseMin(limits_.torque_limit());
}

Position TorqueCycle::position() const noexcept {
  const Position asked = holding_ ? Position::kOfArm : gains_.now().settings.position;
  return side_.resolve(asked, entry().statics);
}

// At rest nothing but the weight is known to act.
void TorqueCycle::look(StaticForm form) noexcept {
  const bool gravity =
      form == StaticForm::kGravity || with_bias(entry().composition, active_.settings.bias).gravity;
  side_.look(position(), state_, {form, gravity, goal_, active_, resting_ ? none_ : tau_null_},
             &seen_);
  const TermsDue terms{.jacobian = due(Term::kJacobian) || cycles_ == 1,
                       .inertia = due(Term::kInertia) || cycles_ == 1,
                       .coriolis = due(Term::kCoriolis) || cycles_ == 1};
  model_.evaluate(seen_.q, seen_.v, terms, &terms_);
}

void TorqueCycle::run(int law, bool from_here) noexcept {
  const bool joints = follows_joints(entry().follows);
  running_ = law;
  switched_ = true;
  if (from_here) {
    resting_ = true;
    look(StaticForm::kGravity);
    goals_.reset(terms_.X_BT, seen_.q);
    inverse_kinematics_.reset(seen_.q);
  } else if (!joints && follows_joints(entry().follows)) {
    // A goal at the tip, followed by the joints from now on.
    inverse_kinematics_.reset(seen_.q);
    inverse_kinematics_.approach(TaskRows(active_.K_x), goals_.goal().X_BD);
  } else if (joints && !follows_joints(entry().follows) && !goals_.at_tip()) {
    goals_.follow_tip(goal_.X_BD);
  }
  forget_energy();
  match_goals();
  refresh_gains();
  resting_ = false;
  look(entry().statics);
  tau_null_ = entry().composition.null_space ? null_space() : none_;
  if (position() == Position::kStatic) look(entry().statics);
  // A law starts with terms of now, due or not.
  LawInputs now = inputs(0.0);
  now.stiffness_due = now.damping_due = true;
  laws_[static_cast<std::size_t>(law)]->start(now);
}

const char* TorqueCycle::set_goal(const compliance_goal_t& message) noexcept {
  const bool to_tip = message.kind == compliance_goal_t::GOAL_WRENCH
                          ? goals_.at_tip()
                          : message.kind != compliance_goal_t::GOAL_JOINT;
  if (const char* reason = goals_.refuse(message, entry().follows)) return reason;
  if (follows_joints(entry().follows) && to_tip != goals_.at_tip()) {
    // The other kind of goal starts from where this one is.
    switched_ = true;
    if (to_tip) {
      goals_.follow_tip(goal_.X_BD);
      inverse_kinematics_.reset(goal_.q_d);
    } else {
      goals_.follow_joints(goal_.q_d);
    }
  }
  return goals_.set(message, entry().follows);
}

// Of what is asked: the link of an elastic joint cannot be made stiffer than its spring.
const char* TorqueCycle::refuse_stiffness(const LawEntry& wanted) const noexcept {
  if (side_.resolve(asked_.settings.position, wanted.statics) == Position::kMotor) return nullptr;
  const JointSprings& springs = side_.springs();
  if (wanted.statics == StaticForm::kJointSpring) {
    return springs.refuse(asked_.K_q, springs.at_rest());
  }
  if (wanted.statics != StaticForm::kTipSpring) return nullptr;
  Gains here = asked_;
  turn_to_base(goal_.X_BD.Q.toRotationMatrix(), &here);
  return springs.refuse(here.K_x, terms_.J, springs.at_rest());
}

const char* TorqueCycle::set_gains(const compliance_gains_t& message, bool active) noexcept {
  if (const char* reason = refuse_gains(message, model_.size())) return reason;
  const int law = message.law.empty() ? selected_ : find_law(message.law);
  if (law < 0) return "no control law has this name";
  const LawEntry& wanted = laws()[static_cast<std::size_t>(law)];
  if (const char* reason = refuse_law(wanted, sensors_)) return reason;
  read_gains(message, &asked_);
  if (const char* reason = refuse_settings(asked_.settings, sensors_)) return reason;
  if (const char* reason = refuse_position(asked_.settings.position, wanted, sensors_))
    return reason;
  if (const char* reason = refuse_stiffness(wanted)) return reason;
  if (const char* reason = laws_[static_cast<std::size_t>(law)]->refuse(asked_)) return reason;
  if (wanted.refuse != nullptr) {
    if (const char* reason = wanted.refuse(asked_, model_.size())) return reason;
  }

  const Gains& now = gains_.now();
  if (asked_.settings != now.settings || asked_.M_x != now.M_x || asked_.M_q != now.M_q) {
    switched_ = true;
  }
  estimation_.set(asked_.settings);
  passivity_.set_max_damping(asked_.settings.passivity_damping_Ns_per_m);
  if (asked_.settings.tank_J != now.settings.tank_J) {
    tank_ =
        EnergyTank({asked_.settings.tank_J, 0.0, asked_.settings.tank_J, kTankShare}, active_.K_x);
  }
  gains_.start(asked_, message.ramp_s);
  selected_ = law;
  // A law that follows a goal goes on with the one there is.
  const bool nothing = wanted.follows == Follows::kNothing || entry().follows == Follows::kNothing;
  if (active && law != running_) run(law, nothing);
  return nullptr;
}

// A law for the joints gets both: the goal at the tip and the joints that go with it.
void TorqueCycle::match_goals() noexcept {
  goal_ = goals_.goal();
  if (!follows_joints(entry().follows)) return;
  if (goals_.at_tip()) {
    inverse_kinematics_.track(TaskRows(active_.K_x), state_.period_s, &goal_);
  } else {
    goal_.X_BD = model_.tip_pose(goal_.q_d);
    goal_.V_BD = model_.jacobian(goal_.q_d) * goal_.v_d;
  }
}

void TorqueCycle::refresh_gains() noexcept {
  active_ = gains_.now();
  if (holding_) active_.settings = LawSettings{};
  turn_to_base(goal_.X_BD.Q.toRotationMatrix(), &active_);
  keep_within_springs();
  if (active_.settings.tank_J > 0.0) draw_from_tank();
}

// In another pose, or with less preload, than where the gains were taken.
void TorqueCycle::keep_within_springs() noexcept {
  softened_ = false;
  if (!side_.springs().any() || position() == Position::kMotor) return;
  if (entry().statics == StaticForm::kJointSpring) {
    active_.K_q = side_.springs().within(active_.K_q, side_.K_J());
  }
  if (entry().statics != StaticForm::kTipSpring) return;
  const double share = JointSprings::allowed_share(active_.K_x, terms_.J, side_.K_J());
  active_.K_x *= share;
  softened_ = share < 1.0;
}

// A stiffer spring takes its energy from the tank; the damper of the cycle before has filled it.
void TorqueCycle::draw_from_tank() noexcept {
  const PoseError error = pose_error(terms_.X_BT, goal_.X_BD, active_.settings.orientation);
  const Vector6 V = terms_.V_BT - goal_.V_BD;
  // As a matrix that dissipates just that along V.
  const Matrix6 D = dissipated_W_ / std::max(V.squaredNorm(), kSlowest) * Matrix6::Identity();
  dissipated_W_ = 0.0;  // counts once
  active_.K_x = tank_.update(active_.K_x, D, error.e, V, state_.period_s);
}

void TorqueCycle::forget_energy() noexcept {
  passivity_.reset();
  F_on_its_way_.setZero();
  dissipated_W_ = 0.0;
}

// Energy of spring and damper against the goal; what else the law exerts is meant to do work. What
// was computed in the cycle before acts from now on.
void TorqueCycle::keep_passive() noexcept {
  if (entry().follows != Follows::kPoseGoal) {
    passivity_.reset();
    return;
  }
  if (!passivity_.started()) passivity_.reset(law_.spring_energy_J);
  passivity_.observe(terms_.X_BT.p - goal_.X_BD.p);
  passivity_.hold(F_on_its_way_);
  const Eigen::Vector3d V = (terms_.V_BT - goal_.V_BD).head<3>();
  const Eigen::Vector3d F_added = -passivity_.damping(V, state_.period_s) * V;
  law_.tau_damping += terms_.J.topRows<3>().transpose() * F_added;
  law_.F.head<3>() += F_added;
  F_on_its_way_ = (law_.F - law_.F_other).head<3>();
}

VectorJ TorqueCycle::friction() const noexcept {
  if (active_.settings.friction == FrictionCompensation::kNone) return none_;
  VectorJ v_d = goal_.v_d;
  if (!follows_joints(entry().follows)) {
    v_d = damped_inverse(terms_.J).inverse * goal_.V_BD;
  }
  return estimation_.friction(v_d, seen_);
}

bool TorqueCycle::control(double dt_s) noexcept {
  // What the driver did not follow is nothing to count steps from.
  if (limits_.far_from_previous(state_.tau_applied, state_.period_s)) {
    limits_.set_previous(state_.tau_applied);
  }
  goals_.advance(dt_s);
  gains_.advance(dt_s);
  blend_.advance(dt_s, state_.v);
  match_goals();
  refresh_gains();
  resting_ = false;
  if (position() == Position::kStatic) look(entry().statics);  // with the goal of now
  if (side_.solved() != solved_) switched_ = true;
  solved_ = side_.solved();

  const Composition add = with_bias(entry().composition, active_.settings.bias);
  law_.reset();
  laws_[static_cast<std::size_t>(running_)]->compute(inputs(dt_s), &law_);
  dissipated_W_ = std::max(-law_.tau_damping.dot(seen_.v), 0.0);
  keep_passive();
  tau_null_ = add.null_space ? null_space() : none_;
  tau_gravity_ = add.gravity ? terms_.g : none_;
  tau_coriolis_ = add.coriolis ? terms_.Cv : none_;
  tau_friction_ = friction();
  VectorJ tau = law_.tau() + tau_null_ + tau_gravity_ + tau_coriolis_ + tau_friction_;

  limits_active_ = law_.limits | limits_.shape(state_, terms_, &tau);
  if (!tau.allFinite()) return false;
  if (switched_) blend_.start(limits_.previous(), tau);
  switched_ = false;
  blend_.add_to(&tau);
  if (blend_.active() || gains_.moving()) limits_active_ |= controller_status_t::LIMIT_RAMP;
  limits_active_ |= limits_.clamp(state_.period_s, &tau);
  if (softened_ || !solved_) limits_active_ |= controller_status_t::LIMIT_ERROR;
  limits_active_ |=
      preload_.control(state_, law_.sets_preload ? law_.preload : preload_.preload_at_rest(),
                       side_.deflection(), tau, dt_s);
  return true;
}

VectorJ TorqueCycle::null_space() noexcept {
  const TaskRows rows(active_.K_x);
  if (!(rows == rows_)) switched_ = true;  // the task lost or gained a direction
  rows_ = rows;
  return null_space_torque(seen_, terms_, goal_, active_, rows, null_limit_);
}

void TorqueCycle::rest(const VectorJ& target, bool in_steps, PreloadAtRest preload) noexcept {
  VectorJ tau = target;
  if (!resting_) {
    resting_ = true;
    look(StaticForm::kGravity);
  }
  preload_.rest(state_, side_.deflection(), preload, in_steps);
  goals_.reset(terms_.X_BT, seen_.q);
  goal_ = goals_.goal();
  law_.reset();
  forget_energy();
  tau_null_.setZero();
  tau_gravity_ = gravity_;
  tau_coriolis_.setZero();
  tau_friction_.setZero();
  limits_active_ = 0;
  if (in_steps) {
    limits_active_ = limits_.clamp(state_.period_s, &tau);
  } else {
    limits_.set_previous(tau);
  }
}

}  // namespace limber::controller
