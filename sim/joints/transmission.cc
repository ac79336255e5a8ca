#include "sim/joints/transmission.h"

#include <algorithm>
#include <cmath>

namespace limber::sim {
namespace {

bool pulls_only(const TransmissionConfig& config) {
  return config.kind == TransmissionKind::kAntagonistic &&
         (config.spring.law == SpringLaw::kQuadratic ||
          config.spring.law == SpringLaw::kExponential);
}

}  // namespace

Transmission::Transmission(const TransmissionConfig& config)
    : kind_(config.kind),
      spring_(config.spring, pulls_only(config)),
      damping_(config.damping_Nms_per_rad),
      half_backlash_(0.5 * config.backlash_rad) {}

double Transmission::beyond(double stretch) const noexcept {
  return std::copysign(std::max(std::abs(stretch) - half_backlash_, 0.0), stretch);
}

bool Transmission::engaged(double stretch) const noexcept {
  const double s = beyond(stretch);
  return !one_sided() || s > 0.0 || (s < 0.0 && !spring_.pull_only());
}

double Transmission::torque(double stretch, double rate) const noexcept {
  if (!engaged(stretch)) return 0.0;
  const double s = beyond(stretch);
  const double torque = spring_.torque(s) + damping_ * rate;
  if (!one_sided()) return torque;
  return s > 0.0 ? std::max(torque, 0.0) : std::min(torque, 0.0);
}

double Transmission::stiffness(double stretch) const noexcept {
  return engaged(stretch) ? spring_.stiffness(beyond(stretch)) : 0.0;
}

double Transmission::torque_at_rest(double ahead, double preload) const noexcept {
  if (kind_ != TransmissionKind::kAntagonistic) return spring_torque(ahead);
  return spring_torque(preload + ahead) - spring_torque(preload - ahead);
}

double Transmission::deflection(double torque, double preload) const {
  constexpr double kFurthest = 1e3;
  constexpr int kHalvings = 100;
  if (rigid() || torque == 0.0) return 0.0;
  double near = 0.0;
  double far = 1e-3;
  while (far < kFurthest && torque_at_rest(far, preload) < std::abs(torque)) far *= 2.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (near + far);
    (torque_at_rest(middle, preload) < std::abs(torque) ? near : far) = middle;
  }
  return std::copysign(far, torque);
}

}  // namespace limber::sim
