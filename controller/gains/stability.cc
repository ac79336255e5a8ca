#include "controller/gains/stability.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "controller/gains/elastic_design.h"
#include "controller/gains/sampling_limits.h"

namespace limber::controller {
namespace {

constexpr double kNoStiffness = 1e-9;  // of the stiffest mode
constexpr double kCyclesToMotor = 1.0;

// Damping as designed for a mode, or as given, in joint coordinates.
struct Damper {
  bool given;
  double ratio;
  const MatrixJ& D;
};

// Stiffest stable spring of a mode with unit mass.
double stiffest(const Damper& damper, double modal_damping, double T) noexcept {
  const double t_d = kCyclesToMotor * T;
  if (!damper.given) return delay_stiffness_limit(1.0, damper.ratio, 0.5 * T + t_d);
  if (!(modal_damping < delayed_damping_limit(1.0, T))) return 0.0;
  return stiffness_limit(modal_damping, T, t_d);
}

StiffnessModes modes_of(const MatrixJ& M, const MatrixJ& K, const Damper& damper,
                        double T) noexcept {
  StiffnessModes found;
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixJ> eigen(K, M);
  const VectorJ stiffness = eigen.eigenvalues();
  for (Eigen::Index i = 0; i < stiffness.size(); ++i) {
    if (stiffness[i] <= kNoStiffness * stiffness.maxCoeff()) continue;
    const VectorJ u = eigen.eigenvectors().col(i);
    const double damping = damper.given ? u.dot(damper.D * u) : 0.0;
    found.modes[static_cast<std::size_t>(found.count++)] = {
        std::sqrt(stiffness[i]), stiffness[i] / stiffest(damper, damping, T)};
  }
  return found;
}

StiffnessModes modes_of(const ElasticDesign& design) noexcept {
  StiffnessModes found;
  for (std::size_t i = 0; i < design.count; ++i) {
    const ElasticDesign::Mode& mode = design.modes[i];
    found.modes[i] = {mode.frequency_rad_per_s, mode.ratio > 0.0
                                                    ? mode.motor_share
                                                    : std::numeric_limits<double>::infinity()};
  }
  found.count = static_cast<int>(design.count);
  return found;
}

}  // namespace

double StiffnessModes::highest_share() const noexcept {
  double highest = 0.0;
  for (int i = 0; i < count; ++i) {
    const double share = modes[static_cast<std::size_t>(i)].share;
    if (!(share <= highest)) highest = share;
  }
  return highest;
}

StiffnessModes tip_modes(const Gains& gains, const ArmTerms& terms, double T,
                         const JointElasticity* elastic) noexcept {
  if (reckons_with(elastic, gains.settings.damping))
    return modes_of(tip_design(*elastic, terms, gains));
  const MatrixJ K = terms.J.transpose() * gains.K_x * terms.J;
  const MatrixJ D = terms.J.transpose() * gains.D_x * terms.J;
  const bool given = gains.settings.damping == DampingDesign::kGiven;
  return modes_of(terms.M_total, K, {given, gains.damping_ratio, D}, T);
}

StiffnessModes joint_modes(const Gains& gains, const ArmTerms& terms, double T,
                           const JointElasticity* elastic) noexcept {
  if (reckons_with(elastic, gains.settings.joint_damping))
    return modes_of(joint_design(*elastic, terms, gains));
  const bool given = gains.settings.joint_damping == DampingDesign::kGiven;
  return modes_of(terms.M_total, gains.K_q, {given, gains.joint_damping_ratio, gains.D_q}, T);
}

const char* StabilityCheck::check(const Gains& gains, const ArmTerms& terms,
                                  const JointElasticity* elastic) noexcept {
  const double tip = tip_modes(gains, terms, T_, elastic).highest_share();
  const double joints = joint_modes(gains, terms, T_, elastic).highest_share();
  if (tip <= 1.0 && joints <= 1.0) return nullptr;
  const bool at_tip = !(tip <= 1.0);
  const double share = at_tip ? tip : joints;
  const auto write = [&](auto format, auto... values) {
    *fmt::format_to_n(text_.data(), text_.size() - 1, format, values...).out = '\0';
  };
  const char* spring = at_tip ? "K_x" : "K_q";
  if (std::isfinite(share)) {
    write(FMT_STRING("{} is {:.3g} times what is stable at {:g} Hz in this pose"), spring, share,
          1.0 / T_);
  } else {
    write(FMT_STRING("{} is unstable with this damping at {:g} Hz, however soft it is"), spring,
          1.0 / T_);
  }
  return text_.data();
}

}  // namespace limber::controller
