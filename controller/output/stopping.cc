#include "controller/output/stopping.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limber/controller_status_t.hpp>
#include <limits>
#include <numbers>
#include <span>

#include "controller/elastic/joint_springs.h"
#include "controller/output/torque_limiter.h"

namespace limber::controller {
namespace {

constexpr double kShareOfVelocity = 0.8;
constexpr double kShareOfTorque = 0.5;  // the rest is for payloads, other joints, and the way there
constexpr double kLeastBraking = 0.1;   // of the torque limit, where the weight takes the rest
constexpr double kShareOfRate = 0.3;    // likewise, and for joints that unwind together
constexpr double kThrown = 0.4;         // r
constexpr double kSpeedGain_per_s = 8.0;          // kappa
constexpr double kAccelerationGain_per_s = 20.0;  // gamma
// The same of arms with springs in the joints, which faster ones would swing up.
constexpr double kSpringSpeedGain_per_s = 4.0;
constexpr double kSpringAccelerationGain_per_s = 10.0;
// Of the bound on speed: a link on soft springs is up to twice as fast as the motors that bend
// them.
constexpr double kShareOfMotor = 0.5;
// Of the speed that can be stopped, and of the torque that may be: joints below both are far off.
constexpr double kJudgedFrom = 0.2;
constexpr double kKnown_s = 3.0 * Stopping::kMemory_s;
constexpr double kFirm = 0.4;
constexpr double kMovesFrom = 0.02;  // of the speed that can be stopped; dither is slower
constexpr double kStays = 0.25;      // of what a joint's torque changes, for the sake of others
constexpr double kThrownBack = 0.5;  // of the velocity limit, once the torque has unwound
constexpr double kHeavy = 0.5;  // of the torque limit, left by the weight: it must not be thrown
constexpr double kLightFrom = 0.1;  // of the velocity limit, within two cycles
// Of the velocity limit: from here on a force that drives the joint counts, in full at the second.
constexpr double kFast = 0.5;
constexpr double kFastest = 0.8;
constexpr int kSweeps = 10;
// Of the torque that is missing; keeps joints with little effect from going far.
constexpr double kReluctance = 0.5;

// s(x; k, c), and its slope.
struct Speed {
  double value;
  double slope;
};
Speed stoppable(double x, double k, double c) noexcept {
  if (x * k * k <= c) return {k * x, k};
  const double speed = std::sqrt(2.0 * c * (x - 0.5 * c / (k * k)));
  return {speed, c / speed};
}

}  // namespace

/// n^T a <= most.
struct Stopping::Row {
  VectorJ n;
  double most;
  std::int32_t limit;
  VectorJ W_n{};        ///< M^-1 n
  double mobility = 0;  ///< n^T M^-1 n
  double lambda = 0.0;
  double excess(const VectorJ& a) const noexcept { return n.dot(a) - most; }
};

struct Stopping::Rows {
  std::array<Row, 2 * kMaxJoints + 1> all;
  std::size_t count = 0;

  void add(const VectorJ& n, double most, std::int32_t limit) noexcept {
    all[count++] = {n, most, limit};
  }
  std::span<Row> span() noexcept { return std::span(all).first(count); }
  std::span<const Row> span() const noexcept { return std::span(all).first(count); }
};

Stopping::Stopping(const Robot& robot, const VectorJ& torque_Nm)
    : springs_(robot),
      position_min_(torque_Nm.size()),
      position_max_(torque_Nm.size()),
      velocity_(torque_Nm.size()),
      speed_gain_per_s_(kSpeedGain_per_s),
      acceleration_gain_per_s_(kAccelerationGain_per_s),
      torque_(torque_Nm),
      torque_rate_(torque_Nm.size()),
      K_J_(VectorJ::Constant(torque_Nm.size(), std::numeric_limits<double>::infinity())),
      v_(VectorJ::Zero(torque_Nm.size())),
      theta_dot_(v_),
      r_(v_),
      spring_error_(v_),
      spring_Nm_(v_) {
  if (springs_.any()) {
    speed_gain_per_s_ = kSpringSpeedGain_per_s;
    acceleration_gain_per_s_ = kSpringAccelerationGain_per_s;
  }
  Eigen::Index i = 0;
  for (const JointConfig& joint : robot.joints) {
    pairs_.push_back(joint.transmission.kind == TransmissionKind::kAntagonistic);
    any_pair_ |= pairs_.back();
    turns_rigidly_.push_back(joint.rigid() && joint.type != JointType::kPrismatic);
    if (!joint.rigid()) K_J_[i] = springs_.at_rest()[i];
    position_min_[i] = joint.position_min;
    position_max_[i] = joint.position_max;
    velocity_[i] = kShareOfVelocity * joint.velocity_limit;
    torque_rate_[i++] = kShareOfGateStep * joint.torque_rate_limit_Nm_per_s;
  }
}

// Only between two states without a gap is the change of speed what the torque has made.
void Stopping::observe(const ArmState& state, const ArmTerms& terms) noexcept {
  const double dt = 1e-9 * static_cast<double>(state.time_ns - time_ns_);
  const bool follows = time_ns_ >= 0 && dt > 0.0 && dt < 1.5 * state.period_s;
  time_ns_ = state.time_ns;
  const VectorJ dv = state.v_reported - v_;
  const VectorJ dtheta_dot = state.theta_dot_reported - theta_dot_;
  v_ = state.v_reported;
  theta_dot_ = state.theta_dot_reported;
  if (!follows) {
    r_.setZero();
    spring_error_.setZero();
    observed_s_ = 0.0;
    return;
  }
  observed_s_ += dt;
  const VectorJ force = state.tau_applied - terms.g - terms.Cv + r_;
  const VectorJ rotors = (terms.M_total - terms.M) * dtheta_dot;
  const VectorJ gained = terms.M * dv + rotors;
  r_ += (gained - dt * force) / kMemory_s;
  if (!any_pair_) return;
  const VectorJ believed_Nm = springs_.torque(state.theta - state.q, state.preload);
  const VectorJ left_Nm = state.tau_applied - (believed_Nm + spring_error_);
  spring_error_ += (dt * left_Nm - rotors) / kMemory_s;
  const VectorJ share = theta_dot_.cwiseAbs().cwiseQuotient(velocity_) / kJudgedFrom;
  const VectorJ slow = (1.0 - share.array()).cwiseMax(0.0);
  spring_Nm_ = believed_Nm + slow.cwiseProduct(spring_error_);
}

bool Stopping::firm(Eigen::Index i, const ArmTerms& terms) const noexcept {
  return K_J_[i] >= kFirm / (kMemory_s * kMemory_s) * terms.M_total(i, i);
}

double Stopping::weight_over(double way, Eigen::Index i, double sign,
                             const ArmTerms& terms) const noexcept {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  if (!turns_rigidly_[static_cast<std::size_t>(i)] || !(way > 0.0)) return terms.g[i];
  const double x = std::min(way, kTurn);
  const double mean =
      (terms.g[i] * std::sin(x) + sign * terms.g_slope[i] * (1.0 - std::cos(x))) / x;
  return sign * std::min(sign * mean, sign * terms.g[i]);
}

void Stopping::bound_joint(Eigen::Index i, double sign, const ArmState& state,
                           const ArmTerms& terms, const VectorJ& load, const VectorJ& tau,
                           Rows* rows) const noexcept {
  const double u = std::max(sign * state.v_reported[i], sign * state.theta_dot_reported[i]);
  const double d = sign > 0.0 ? position_max_[i] - state.q[i] : state.q[i] - position_min_[i];
  const double M = terms.M_total(i, i);
  const double weight_Nm = weight_over(d, i, sign, terms);
  const double braking =
      std::max(torque_[i] + sign * (load[i] - terms.g[i] + weight_Nm), kLeastBraking * torque_[i]);
  Speed most = stoppable(d, speed_gain_per_s_, kShareOfTorque * braking / M);
  std::int32_t limit = controller_status_t::LIMIT_POSITION;
  if (!(most.value < velocity_[i])) {
    most = {velocity_[i], 0.0};
    limit = controller_status_t::LIMIT_VELOCITY;
  }
  const double jerk = kShareOfRate * torque_rate_[i] / M;
  const double spare = stoppable(most.value - u, acceleration_gain_per_s_, jerk).value;
  const double a_most = spare - std::max(u, 0.0) * most.slope;
  const bool known = observed_s_ > kKnown_s;
  const double a = sign * (tau[i] - load[i]) / M;
  const bool pushed = known && u > kMovesFrom * most.value && a > kJudgedFrom * a_most;
  const bool heavy = braking < kHeavy * torque_[i];
  const double back =
      heavy ? std::min(kThrownBack * velocity_[i], most.value) : kThrownBack * velocity_[i];
  const bool thrown = known && u < 0.0 && a > 0.0 && u + 0.5 * a * a / jerk > back;
  const double step = 2.0 * state.period_s;
  const bool light = step * torque_[i] > kThrownBack * velocity_[i] * M &&
                     u + step * a > kLightFrom * velocity_[i];
  if (u < kJudgedFrom * most.value && !pushed && !thrown && !light) return;
  rows->add(sign * VectorJ::Unit(state.q.size(), i), a_most, limit);
}

void Stopping::bound_energy(const ArmState& state, const ArmTerms& terms,
                            Rows* rows) const noexcept {
  const VectorJ left = (torque_ - terms.g.cwiseAbs()).cwiseMax(kLeastBraking * torque_);
  const double thrown = terms.Cv.cwiseAbs().cwiseQuotient(left).maxCoeff();
  if (!(thrown > kJudgedFrom * kThrown)) return;
  const VectorJ momentum = terms.M_total * state.v_reported;
  const double E = 0.5 * state.v_reported.dot(momentum);
  const double p = momentum.norm();
  rows->add(momentum / p, acceleration_gain_per_s_ * E * (kThrown / thrown - 1.0) / p,
            controller_status_t::LIMIT_VELOCITY);
}

// Least squares of what is left beyond the bounds, joint by joint, as far as each brakes itself or
// changes its torque less: what throws a joint is that the others' torques change.
void Stopping::let_others_help(const Rows& rows, const MatrixJ& W, const ArmState& state,
                               const ArmTerms& terms, const Reach& reach, VectorJ* a,
                               VectorJ* tau) const noexcept {
  const VectorJ& v = state.v_reported;
  const VectorJ held =
      (*tau + kStays * (state.tau_applied - *tau)).cwiseMax(reach.low).cwiseMin(reach.high);
  const VectorJ low = (v.array() > 0.0).select(reach.low, tau->cwiseMin(held));
  const VectorJ high = (v.array() < 0.0).select(reach.high, tau->cwiseMax(held));
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (Eigen::Index j = 0; j < tau->size(); ++j) {
      if (!firm(j, terms)) continue;
      double slope = 0.0;
      double curvature = kReluctance;
      for (const Row& row : rows.span()) {
        const double missing = row.excess(*a) / row.mobility;
        if (!(missing > 0.0)) continue;
        const double effect = row.W_n[j] / row.mobility;
        slope += missing * effect;
        curvature += effect * effect;
      }
      const double wanted = std::clamp((*tau)[j] - slope / curvature, low[j], high[j]);
      *a += (wanted - (*tau)[j]) * W.col(j);
      (*tau)[j] = wanted;
    }
  }
}

// The spring's torque is the rotor's only load, so its acceleration is known without the link's.
std::int32_t Stopping::bound_motors(const ArmState& state, const ArmTerms& terms,
                                    const Reach& reach, VectorJ* tau) const noexcept {
  if (!any_pair_ || observed_s_ < kKnown_s) return 0;
  std::int32_t acted = 0;
  for (Eigen::Index i = 0; i < tau->size(); ++i) {
    if (!pairs_[static_cast<std::size_t>(i)] || firm(i, terms)) continue;
    const double B = terms.M_total(i, i) - terms.M(i, i);
    const double u = state.theta_dot_reported[i];
    const bool bends = (spring_Nm_[i] - terms.g[i]) * u > 0.0;
    const double most = bends ? kShareOfMotor * velocity_[i] : velocity_[i];
    const double jerk = kShareOfRate * torque_rate_[i] / B;
    const auto spare_Nm = [&](double speed) {
      return B * stoppable(most - speed, kAccelerationGain_per_s, jerk).value;
    };
    const double low = std::clamp(spring_Nm_[i] - spare_Nm(-u), reach.low[i], reach.high[i]);
    const double high = std::clamp(spring_Nm_[i] + spare_Nm(u), reach.low[i], reach.high[i]);
    const double kept = std::clamp((*tau)[i], low, high);
    if (kept == (*tau)[i]) continue;
    (*tau)[i] = kept;
    acted |= controller_status_t::LIMIT_VELOCITY;
  }
  return acted;
}

std::int32_t Stopping::shape(const ArmState& state, const ArmTerms& terms, const Reach& reach,
                             VectorJ* tau) const noexcept {
  std::int32_t acted = bound_motors(state, terms, reach, tau);
  VectorJ load = terms.Cv + terms.g;
  const VectorJ pushing = *tau - load;
  const VectorJ against = r_.cwiseMax(-pushing.cwiseMax(0.0)).cwiseMin(-pushing.cwiseMin(0.0));
  const VectorJ share = state.v_reported.cwiseAbs().cwiseQuotient(velocity_);
  const VectorJ fast = ((share.array() - kFast) / (kFastest - kFast)).cwiseMax(0.0).cwiseMin(1.0);
  const VectorJ driven = (r_.array() * state.v_reported.array() > 0.0).select(r_ - against, 0.0);
  load -= against + fast.cwiseProduct(driven);
  Rows rows;
  for (Eigen::Index i = 0; i < tau->size(); ++i) {
    for (const double sign : {-1.0, 1.0}) bound_joint(i, sign, state, terms, load, *tau, &rows);
  }
  bound_energy(state, terms, &rows);
  if (rows.count == 0) return acted;
  const auto n = tau->size();
  const MatrixJ W = terms.M_total.llt().solve(MatrixJ::Identity(n, n));
  VectorJ a = W * (*tau - load);
  const auto kept = [&a](const Row& row) { return row.excess(a) <= 0.0; };
  if (std::ranges::all_of(rows.span(), kept)) return acted;

  for (Row& row : rows.span()) {
    row.W_n = W * row.n;
    row.mobility = row.n.dot(row.W_n);
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (Row& row : rows.span()) {
      const double lambda = std::max(row.lambda + row.excess(a) / row.mobility, 0.0);
      const double step = row.lambda - lambda;
      row.lambda = lambda;
      *tau += step * row.n;
      a += step * row.W_n;
    }
  }
  for (const Row& row : rows.span()) {
    if (row.lambda > 0.0) acted |= row.limit;
  }
  const VectorJ reached = tau->cwiseMax(reach.low).cwiseMin(reach.high);
  if (reached != *tau) {
    a += W * (reached - *tau);
    *tau = reached;
    let_others_help(rows, W, state, terms, reach, &a, tau);
  }
  return acted;
}

}  // namespace limber::controller
