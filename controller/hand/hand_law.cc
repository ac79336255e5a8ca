#include "controller/hand/hand_law.h"

#include <algorithm>
#include <cmath>

#include "controller/output/torque_limiter.h"

namespace limber::controller {
namespace {

constexpr double kStill_m_per_s = 2e-3;
constexpr double kPressing = 0.8;  // of the bound
constexpr double kBeyond_m = 2e-3;
constexpr double kLost_m = 1e-3;
constexpr double kEnds_m = 5e-4;
constexpr double kArrived_m = 1e-9;

}  // namespace

HandLaw::HandLaw(const HandConfig& hand)
    : travel_(hand.travel),
      stiffness_(hand.stiffness_N_per_m),
      damping_(hand.damping_Ns_per_m),
      hold_force_N_(hand.hold_force_N),
      torque_limit_Nm_(hand.drive.torque_limit_Nm),
      torque_rate_Nm_per_s_(kShareOfGateStep * hand.drive.torque_rate_limit_Nm_per_s),
      heat_(hand.rated_torque_Nm, hand.drive.drive.peak_torque_Nm, hand.heat_time_constant_s) {}

void HandLaw::begin(const HandReading& at, double torque) noexcept {
  const double force = torque / travel_.slope(at.angle_rad);
  target_m_ = travel_.width(at.angle_rad) + force / stiffness_;
  goal_.width_m = target_m_;
  goal_.force_N = std::max(std::abs(force), hold_force_N_);
  goal_.speed_m_per_s = 0.0;
  torque_ = torque;
  still_s_ = pressed_s_ = 0.0;
  grasped_ = travelling_ = false;
}

double HandLaw::bound(double slope) const noexcept {
  const double most = std::min(torque_limit_Nm_, heat_.bound()) / std::abs(slope);
  return std::min({goal_.force_N, grasped_ ? hold_force_N_ : most, most});
}

void HandLaw::advance_target(double width, double dt_s) noexcept {
  const double way = goal_.width_m - target_m_;
  const double step = std::min(std::abs(way), goal_.speed_m_per_s * dt_s);
  const double next =
      std::abs(way) <= kArrived_m ? goal_.width_m : target_m_ + std::copysign(step, way);
  const bool leads = std::abs(next - width) > bound_N_ / stiffness_ + kLead_m &&
                     std::abs(next - width) > std::abs(target_m_ - width);
  travelling_ = !leads && next != target_m_;
  if (!leads) target_m_ = next;
}

double HandLaw::step(const HandReading& at, double dt_s) noexcept {
  const double width = travel_.width(at.angle_rad);
  const double slope = travel_.slope(at.angle_rad);
  const double speed = slope * at.rate_rad_per_s;
  heat_.add(torque_, dt_s);
  bound_N_ = bound(slope);
  advance_target(width, dt_s);
  const double spring = stiffness_ * (target_m_ - width) - damping_ * speed;
  const double force = std::clamp(spring, -bound_N_, bound_N_);
  const double change = torque_rate_Nm_per_s_ * dt_s;
  torque_ = std::clamp(force * slope, torque_ - change, torque_ + change);
  judge_grasp(width, speed, torque_ / slope, dt_s);
  return torque_;
}

void HandLaw::judge_grasp(double width, double speed, double force, double dt_s) noexcept {
  const double beyond = std::abs(width - target_m_);
  still_s_ = std::abs(speed) < kStill_m_per_s ? still_s_ + dt_s : 0.0;
  const bool at_end = width < travel_.closed_m() + kEnds_m || width > travel_.open_m() - kEnds_m;
  const bool pressing =
      std::abs(force) >= kPressing * bound_N_ && force * (target_m_ - width) > 0.0;
  pressed_s_ = pressing && beyond > kBeyond_m && !at_end && bound_N_ > 0.0 && still_s_ > 0.0
                   ? pressed_s_ + dt_s
                   : 0.0;
  if (pressed_s_ >= kStill_s) grasped_ = true;
  if (beyond < kLost_m || at_end) grasped_ = false;
}

void HandLaw::rest(const HandReading& at, double torque, double dt_s) noexcept {
  const double speed = travel_.slope(at.angle_rad) * at.rate_rad_per_s;
  heat_.add(torque, dt_s);
  torque_ = torque;
  still_s_ = std::abs(speed) < kStill_m_per_s ? still_s_ + dt_s : 0.0;
  pressed_s_ = 0.0;
  travelling_ = false;
}

}  // namespace limber::controller
