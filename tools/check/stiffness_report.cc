#include "tools/check/stiffness_report.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <variant>

#include "controller/gains/gains.h"
#include "controller/gains/sampling_limits.h"
#include "controller/model/arm_terms.h"
#include "robots/loader/default_gains.h"
#include "tools/check/json.h"

namespace limber {
namespace {

using controller::DampingDesign;

constexpr double kClose = 0.5;
constexpr double kNoStiffness = 1e-9;  // of the stiffest mode
constexpr double kCyclesToMotor = 1.0;

/// Damping as designed for a mode, or as given.
struct Damper {
  bool given;
  double ratio;
  Eigen::MatrixXd D;
};

double stiffest(const Damper& damper, double modal_damping, double T) {
  const double t_d = kCyclesToMotor * T;
  if (!damper.given) return controller::delay_stiffness_limit(1.0, damper.ratio, 0.5 * T + t_d);
  if (!(modal_damping < controller::delayed_damping_limit(1.0, T))) return 0.0;
  return controller::stiffness_limit(modal_damping, T, t_d);
}

/// n x n, in joint coordinates, M with rotors. Modes without stiffness are left out.
std::vector<ModeReport> modes(const Eigen::MatrixXd& M, const Eigen::MatrixXd& K,
                              const Damper& damper, double T) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(K, M);
  const Eigen::VectorXd& stiffness = eigen.eigenvalues();
  std::vector<ModeReport> found;
  for (Eigen::Index i = 0; i < stiffness.size(); ++i) {
    if (stiffness[i] <= kNoStiffness * stiffness.maxCoeff()) continue;
    const Eigen::VectorXd u = eigen.eigenvectors().col(i);
    found.push_back(
        {std::sqrt(stiffness[i]), stiffness[i] / stiffest(damper, u.dot(damper.D * u), T)});
  }
  return found;
}

StiffnessReport report(double at_s, const compliance_gains_t& message,
                       const controller::ArmTerms& terms, double T) {
  controller::Gains gains(static_cast<int>(terms.B.size()));
  controller::read_gains(message, &gains);
  const Eigen::MatrixXd J = terms.J;
  const auto given = [](DampingDesign design) { return design == DampingDesign::kGiven; };
  const Damper tip{given(gains.settings.damping), gains.damping_ratio,
                   J.transpose() * gains.D_x * J};
  const Damper joints{given(gains.settings.joint_damping), gains.joint_damping_ratio, gains.D_q};
  return {at_s, modes(terms.M_total, J.transpose() * gains.K_x * J, tip, T),
          modes(terms.M_total, gains.K_q, joints, T)};
}

std::string summary(const std::vector<ModeReport>& modes) {
  if (modes.empty()) return "no spring";
  const double share = highest_share(modes);
  if (!std::isfinite(share)) return "unstable with this damping";
  return fmt::format("up to {:.0f} rad/s, {:.2g} % of the stiffest: {}",
                     modes.back().frequency_rad_per_s, 100.0 * share, verdict(share));
}

std::string modes_json(const std::vector<ModeReport>& modes) {
  std::vector<std::string> written;
  for (const ModeReport& mode : modes) {
    written.push_back(json::object({{"frequency_rad_per_s", json::number(mode.frequency_rad_per_s)},
                                    {"share_of_stiffest", json::number(mode.share)},
                                    {"verdict", json::text(verdict(mode.share))}}));
  }
  return json::list(written);
}

}  // namespace

const char* verdict(double share) {
  if (!(share <= 1.0)) return "unstable";
  return share <= kClose ? "ok" : "close";
}

double highest_share(const std::vector<ModeReport>& modes) {
  double highest = 0.0;
  for (const ModeReport& mode : modes) {
    if (!(mode.share <= highest)) highest = mode.share;
  }
  return highest;
}

std::vector<StiffnessReport> make_stiffness_reports(const Scenario& scenario,
                                                    const LoadedRobot& robot) {
  controller::ArmModel model(robot);
  controller::ArmTerms terms(model.size());
  const VectorJ q = Eigen::Map<const Eigen::VectorXd>(scenario.start_q.data(), model.size());
  model.evaluate(q, VectorJ::Zero(model.size()), &terms);
  const double T = 1.0 / robot.robot.rate_hz;
  std::vector<StiffnessReport> reports{report(0.0, default_gains(robot.robot), terms, T)};
  for (const TimedMessage& timed : scenario.timeline) {
    const auto* gains = std::get_if<compliance_gains_t>(&timed.message);
    if (gains == nullptr) continue;
    reports.push_back(report(static_cast<double>(timed.time_ns) * 1e-9, *gains, terms, T));
  }
  return reports;
}

std::vector<std::string> stiffness_warnings(const std::vector<StiffnessReport>& reports,
                                            double rate_hz) {
  std::vector<std::string> warnings;
  for (const StiffnessReport& report : reports) {
    for (const auto& [name, modes] : {std::pair{"K_x", &report.tip}, {"K_q", &report.joints}}) {
      const double share = highest_share(*modes);
      if (share <= 1.0) continue;
      const std::string much = std::isfinite(share)
                                   ? fmt::format("{:.3g} times what is stable", share)
                                   : "unstable with this damping, however soft it is,";
      warnings.push_back(fmt::format("gains at {:g} s: {} is {} at {:g} Hz at the start pose",
                                     report.at_s, name, much, rate_hz));
    }
  }
  return warnings;
}

std::string stiffness_text(const std::vector<StiffnessReport>& reports, double rate_hz) {
  std::string text = fmt::format(
      "  modes at the start pose, against the stiffest that is stable at {:g} Hz:\n", rate_hz);
  for (const StiffnessReport& report : reports) {
    text += fmt::format("  {:8.3f} s  tip {}; joints {}\n", report.at_s, summary(report.tip),
                        summary(report.joints));
  }
  return text;
}

std::string stiffness_json(const std::vector<StiffnessReport>& reports) {
  std::vector<std::string> written;
  for (const StiffnessReport& report : reports) {
    written.push_back(json::object({{"at_s", json::number(report.at_s)},
                                    {"tip", modes_json(report.tip)},
                                    {"joints", modes_json(report.joints)}}));
  }
  return json::list(written);
}

}  // namespace limber
