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

}  // namespace

TorqueCycle::TorqueCycle(const LoadedRobot& robot, const std::string& law)
    : model_(robot),
      state_(model_.size()),
      terms_(model_.size()),
      sensors_(sensors_of(robot.robot)),
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
      null_limit_(kNullShare * limits_.torque_limit()),
      none_(VectorJ::Zero(model_.size())),
      law_(model_.size()),
      tau_null_(none_),
      tau_gravity_(none_),
      tau_coriolis_(none_),
      tau_friction_(none_),
      gravity_(none_) {
  for (const LawEntry& entry : laws()) {
    const bool possible = refuse_law(entry, sensors_) == nullptr;
    laws_.push_back(possible ? entry.make(robot) : nullptr);
  }
}

bool TorqueCycle::due(Term term) const noexcept {
  return cycles_ % gains_.now().settings.period_cycles[static_cast<std::size_t>(term)] == 0;
}

LawInputs TorqueCycle::inputs(double dt_s) const noexcept {
  return {.state = state_,
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
  const TermsDue terms{.jacobian = due(Term::kJacobian) || cycles_ == 1,
                       .inertia = due(Term::kInertia) || cycles_ == 1,
                       .coriolis = due(Term::kCoriolis) || cycles_ == 1};
  model_.evaluate(state_.q, state_.v, terms, &terms_);
  estimation_.observe(message, state_, terms_, TaskRows(active_.K_x), &model_);
  if (!terms_.g.allFinite()) return;
  gravity_ = terms_.g.cwiseMax(-limits_.torque_limit()).cwiseMin(limits_.torque_limit());
}

void TorqueCycle::run(int law, bool from_here) noexcept {
  const bool joints = follows_joints(entry().follows);
  running_ = law;
  switched_ = true;
  if (from_here) {
    goals_.reset(terms_.X_BT, state_.q);
    inverse_kinematics_.reset(state_.q);
  } else if (!joints && follows_joints(entry().follows)) {
    // A goal at the tip, followed by the joints from now on.
    inverse_kinematics_.reset(state_.q);
    inverse_kinematics_.approach(TaskRows(active_.K_x), goals_.goal().X_BD);
  } else if (joints && !follows_joints(entry().follows) && !goals_.at_tip()) {
    goals_.follow_tip(goal_.X_BD);
  }
  forget_energy();
  match_goals();
  refresh_gains();
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

const char* TorqueCycle::set_gains(const compliance_gains_t& message, bool active) noexcept {
  if (const char* reason = refuse_gains(message, model_.size())) return reason;
  const int law = message.law.empty() ? selected_ : find_law(message.law);
  if (law < 0) return "no control law has this name";
  const LawEntry& wanted = laws()[static_cast<std::size_t>(law)];
  if (const char* reason = refuse_law(wanted, sensors_)) return reason;
  read_gains(message, &asked_);
  if (const char* reason = refuse_settings(asked_.settings, sensors_)) return reason;
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
  if (active_.settings.tank_J > 0.0) draw_from_tank();
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
  return estimation_.friction(v_d, state_);
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

  const Composition add = with_bias(entry().composition, active_.settings.bias);
  law_.reset();
  laws_[static_cast<std::size_t>(running_)]->compute(inputs(dt_s), &law_);
  dissipated_W_ = std::max(-law_.tau_damping.dot(state_.v), 0.0);
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
  return true;
}

VectorJ TorqueCycle::null_space() noexcept {
  const TaskRows rows(active_.K_x);
  if (!(rows == rows_)) switched_ = true;  // the task lost or gained a direction
  rows_ = rows;
  return null_space_torque(state_, terms_, goal_, active_, rows, null_limit_);
}

void TorqueCycle::rest(const VectorJ& target, bool in_steps) noexcept {
  VectorJ tau = target;
  goals_.reset(terms_.X_BT, state_.q);
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
