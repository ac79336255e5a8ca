#include "controller/observers/estimator_check.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>

namespace limber::controller {

const char* EstimatorCheck::check(const LawSettings& settings, const ArmTerms& terms) noexcept {
  if (settings.velocity != VelocitySource::kLevant) return nullptr;
  const auto n = torque_.size();
  const MatrixJ W = terms.M_total.llt().solve(MatrixJ::Identity(n, n));
  Eigen::Index joint = 0;
  double fastest = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool rigid = rigid_[static_cast<std::size_t>(i)];
    const double most = torque_[i] * (rigid ? W(i, i) : 1.0 / terms.B[i]);
    if (most <= fastest) continue;
    fastest = most;
    joint = i;
  }
  if (fastest <= settings.velocity_acceleration_rad_per_s2) return nullptr;
  *fmt::format_to_n(text_.data(), text_.size() - 1,
                    FMT_STRING("velocity: levant follows {:g} rad/s^2 "
                               "(velocity_acceleration_rad_per_s2); the torque of {} makes {:.3g} "
                               "in this pose, so it needs at least that"),
                    settings.velocity_acceleration_rad_per_s2,
                    joints_[static_cast<std::size_t>(joint)], fastest)
       .out = '\0';
  return text_.data();
}

}  // namespace limber::controller
