#include "controller/impedance/stability.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "controller/impedance/elastic_design.h"
#include "controller/impedance/nullspace.h"
#include "controller/impedance/sampling_limits.h"

namespace limber::controller {
namespace {

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

// The damper alone, of an acceleration W tau: a force that is late by a cycle swings up a joint
// that is damped more than its inertia bears, with a spring or without.
void judge_damper(const MatrixJ& W, const MatrixJ& D, double T, StiffnessModes* found) noexcept {
  const Eigen::EigenSolver<MatrixJ> eigen(W * D);
  Eigen::Index most = 0;
  const double damping = eigen.eigenvalues().cwiseAbs().maxCoeff(&most);
  found->damping_share = damping / delayed_damping_limit(1.0, T);
  Eigen::Index joint = 0;
  eigen.eigenvectors().col(most).cwiseAbs().maxCoeff(&joint);
  found->damped_joint = static_cast<int>(joint);
}

StiffnessModes modes_of(const MatrixJ& M, const MatrixJ& K, const Damper& damper,
                        double T) noexcept {
  StiffnessModes found;
  if (damper.given) {
    judge_damper(M.llt().solve(MatrixJ::Identity(M.rows(), M.cols())), damper.D, T, &found);
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixJ> eigen(K, M);
  const VectorJ& stiffness = eigen.eigenvalues();
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

// Of W = M^-1 N: eigenvectors u of W K with u^T M u = 1 have the stiffness and damping of a mode.
StiffnessModes null_modes(const Gains& gains, const ArmTerms& terms, double T) noexcept {
  StiffnessModes found;
  const TaskRows rows(gains.K_x);
  const LawSettings& s = gains.settings;
  const MatrixJ W =
      terms.M_total.llt().solve(null_space_projector(terms, rows, s.projector, s.lost_share));
  judge_damper(W, gains.D_null, T, &found);
  const Eigen::EigenSolver<MatrixJ> eigen(W * gains.K_null);
  const VectorJ stiffness = eigen.eigenvalues().real();
  for (Eigen::Index i = 0; i < stiffness.size(); ++i) {
    if (!(stiffness[i] > kNoStiffness * stiffness.maxCoeff())) continue;
    VectorJ u = eigen.eigenvectors().col(i).real();
    u /= std::sqrt(u.dot(terms.M_total * u));
    const double damping = u.dot(gains.D_null * u);
    found.modes[static_cast<std::size_t>(found.count++)] = {
        std::sqrt(stiffness[i]), stiffness[i] / stiffest({true, 0.0, gains.D_null}, damping, T)};
  }
  const auto frequency = [](const StiffnessMode& mode) { return mode.frequency_rad_per_s; };
  std::ranges::sort(found.modes.begin(), found.modes.begin() + found.count, {}, frequency);
  return found;
}

const char* StabilityCheck::check(const Gains& gains, const ArmTerms& terms,
                                  const JointElasticity* elastic) noexcept {
  if (const char* text = judge("K_x", "D_x", tip_modes(gains, terms, T_, elastic))) return text;
  if (const char* text = judge("K_q", "D_q", joint_modes(gains, terms, T_, elastic))) return text;
  return judge("K_null", "D_null", null_modes(gains, terms, T_));
}

const char* StabilityCheck::judge(const char* spring, const char* damper,
                                  const StiffnessModes& modes) noexcept {
  const double share = modes.highest_share();
  const bool stiff = !(share <= 1.0);
  const bool damped = !(modes.damping_share <= 1.0);
  if (!stiff && !damped) return nullptr;
  const auto write = [&](auto format, auto... values) {
    *fmt::format_to_n(text_.data(), text_.size() - 1, format, values...).out = '\0';
  };
  const double rate_hz = 1.0 / T_;
  if (damped) {
    write(FMT_STRING("{} is {:.3g} times what is stable at {:g} Hz in this pose, most of it at {}"),
          damper, modes.damping_share, rate_hz,
          joints_[static_cast<std::size_t>(modes.damped_joint)]);
  } else if (std::isfinite(share)) {
    write(FMT_STRING("{} is {:.3g} times what is stable at {:g} Hz in this pose"), spring, share,
          rate_hz);
  } else {
    write(FMT_STRING("{} is unstable with this damping at {:g} Hz, however soft it is"), spring,
          rate_hz);
  }
  return text_.data();
}

}  // namespace limber::controller
