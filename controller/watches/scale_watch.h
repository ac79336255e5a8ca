// Does a joint's motor make a multiple of the torque that it reports?
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

namespace limber::controller {

/// A motor that makes s > 1 times the torque that it reports, by a wrong range or a firmware that
/// has changed it, looks like a stand under the arm: at rest it carries the weight g with g / s, so
/// that r = (s - 1) tau seems to come from outside (LoadWatch). But a stand is left behind once a
/// law moves the arm, or carries less when tau grows; this does not. So a joint of which r was
///
///   abs(r) >= kSeems abs(g),   abs(r) >= what friction may hold
///
/// in HOLD, the same way as tau and g, is suspected until under a law, for kLasting_s
///
///   abs(r - (tau / tau in HOLD) r in HOLD) > kUnlike abs(r)
///
/// and is overdriven if before it has moved by kMovedBy, or tau has become kGrown times as much.
///
/// One joint, N m and rad (N and m). Allowed in the cycle.
class ScaleWatch {
 public:
  static constexpr double kSeems = 0.4;
  static constexpr double kUnlike = 0.25;
  static constexpr double kLasting_s = 0.03;
  static constexpr double kMovedBy = 0.03;
  static constexpr double kGrown = 1.4;

  struct Seen {
    double r;
    double tau;
    double q;
  };

  void forget() noexcept { held_.reset(); }
  /// In HOLD. `weight`: the torque that carries the joint; `friction`: what it may hold.
  void hold(const Seen& now, double weight, double friction) noexcept {
    held_.reset();
    unlike_s_ = 0.0;
    const double least = std::max(kSeems * std::abs(weight), friction);
    const bool same_way = now.r * weight > 0.0 && now.r * now.tau > 0.0;
    if (same_way && std::abs(now.r) >= least) held_ = now;
  }
  bool suspected() const noexcept { return held_.has_value(); }
  /// Under a law, `dt_s` since the last call.
  bool overdriven(const Seen& now, double dt_s) noexcept {
    if (!held_) return false;
    const double grown = now.tau / held_->tau;
    if (std::abs(now.r - grown * held_->r) <= kUnlike * std::abs(now.r)) {
      unlike_s_ = 0.0;
      return grown >= kGrown || std::abs(now.q - held_->q) >= kMovedBy;
    }
    unlike_s_ += dt_s;
    if (unlike_s_ >= kLasting_s) held_.reset();
    return false;
  }

 private:
  std::optional<Seen> held_;
  double unlike_s_{};  ///< in a row, since HOLD
};

}  // namespace limber::controller
