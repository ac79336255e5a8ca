#include "controller/torque_cycle.h"

#include "common/config_error.h"

namespace limber::controller {
namespace {

// The posture may take this share of a joint's torque.
constexpr double kNullShare = 0.3;

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
      hold_(checked_law("joint_impedance", sensors_)),
      selected_(checked_law(law, sensors_)),
      running_(hold_),
      goals_(robot.robot),
      gains_(default_gains(robot.robot)),
      asked_(gains_.now()),
      rows_(gains_.now().K_x),
      blend_(model_.size()),
      limits_(robot.robot),
      null_limit_(kNullShare * limits_.torque_limit()),
      none_(VectorJ::Zero(model_.size())),
      law_(model_.size()),
      tau_null_(none_),
      tau_gravity_(none_),
      tau_coriolis_(none_),
      gravity_(none_) {
  for (const LawEntry& entry : laws()) {
    const bool possible = refuse_law(entry, sensors_) == nullptr;
    laws_.push_back(possible ? entry.make(robot) : nullptr);
  }
}

void TorqueCycle::measure(const joint_state_t& message) noexcept {
  read_arm_state(message, &state_);
  model_.evaluate(state_.q, state_.v, &terms_);
  if (!terms_.g.allFinite()) return;
  gravity_ = terms_.g.cwiseMax(-limits_.torque_limit()).cwiseMin(limits_.torque_limit());
}

void TorqueCycle::run(int law, bool from_here) noexcept {
  running_ = law;
  switched_ = true;
  if (from_here) goals_.reset(terms_.X_BT, state_.q);
  laws_[static_cast<std::size_t>(law)]->start(inputs());
}

const char* TorqueCycle::set_goal(const compliance_goal_t& message) noexcept {
  return goals_.set(message, entry().follows);
}

const char* TorqueCycle::set_gains(const compliance_gains_t& message, bool active) noexcept {
  if (const char* reason = refuse_gains(message, model_.size())) return reason;
  const int law = message.law.empty() ? selected_ : find_law(message.law);
  if (law < 0) return "no control law has this name";
  const LawEntry& wanted = laws()[static_cast<std::size_t>(law)];
  if (const char* reason = refuse_law(wanted, sensors_)) return reason;

  read_gains(message, &asked_);
  if (asked_.orientation != gains_.now().orientation) switched_ = true;
  gains_.start(asked_, message.ramp_s);
  selected_ = law;
  // A law that follows the same kind of goal goes on with it.
  if (active && law != running_) run(law, wanted.follows != entry().follows);
  return nullptr;
}

bool TorqueCycle::control(double dt_s) noexcept {
  // What the driver did not follow is nothing to count steps from.
  if (limits_.far_from_previous(state_.tau_applied, state_.period_s)) {
    limits_.set_previous(state_.tau_applied);
  }
  goals_.advance(dt_s);
  gains_.advance(dt_s);
  blend_.advance(dt_s, state_.v);

  const Composition add = entry().composition;
  law_.reset();
  laws_[static_cast<std::size_t>(running_)]->compute(inputs(), &law_);
  tau_null_ = add.null_space ? null_space() : none_;
  tau_gravity_ = add.gravity ? terms_.g : none_;
  tau_coriolis_ = add.coriolis ? terms_.Cv : none_;
  VectorJ tau = law_.tau() + tau_null_ + tau_gravity_ + tau_coriolis_;

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
  const TaskRows rows(gains_.now().K_x);
  if (!(rows == rows_)) switched_ = true;  // the task lost or gained a direction
  rows_ = rows;
  return null_space_torque(state_, terms_, goals_.goal(), gains_.now(), rows, null_limit_);
}

void TorqueCycle::rest(const VectorJ& target, bool in_steps) noexcept {
  VectorJ tau = target;
  goals_.reset(terms_.X_BT, state_.q);
  law_.reset();
  tau_null_.setZero();
  tau_gravity_ = gravity_;
  tau_coriolis_.setZero();
  limits_active_ = 0;
  if (in_steps) {
    limits_active_ = limits_.clamp(state_.period_s, &tau);
  } else {
    limits_.set_previous(tau);
  }
}

}  // namespace limber::controller
