#include "tools/check/stiffness_report.h"

#include <fmt/format.h>

#include <cmath>
#include <span>
#include <variant>

#include "controller/gains/gains.h"
#include "controller/model/arm_terms.h"
#include "lcmtypes/gains_merge.h"
#include "robots/loader/default_gains.h"
#include "tools/check/json.h"

namespace limber {
namespace {

using controller::PositionFeedback;
using controller::StiffnessModes;

constexpr double kClose = 0.5;

StiffnessReport report(double at_s, const compliance_gains_t& fields,
                       const controller::ArmTerms& terms, const Robot& robot) {
  controller::Gains gains(robot.size());
  controller::read_gains(fields, &gains);
  const double T = 1.0 / robot.rate_hz;
  const controller::JointSprings springs(robot);
  controller::JointElasticity elastic(robot, springs);
  if (!elastic.designed_for) {
    return {at_s, tip_modes(gains, terms, T), joint_modes(gains, terms, T)};
  }
  elastic.position = gains.settings.position_feedback;
  if (elastic.position == PositionFeedback::kAuto) elastic.position = PositionFeedback::kStatic;
  if (elastic.position != PositionFeedback::kMotor) {
    gains.K_q = springs.within(gains.K_q, elastic.K_J);
  }
  return {at_s, tip_modes(gains, terms, T, &elastic), joint_modes(gains, terms, T, &elastic)};
}

std::span<const controller::StiffnessMode> each(const StiffnessModes& modes) {
  return std::span(modes.modes).first(static_cast<std::size_t>(modes.count));
}

std::string summary(const StiffnessModes& modes) {
  if (modes.count == 0) return "no spring";
  const double share = modes.highest_share();
  if (!std::isfinite(share)) return "unstable with this damping";
  return fmt::format("up to {:.0f} rad/s, {:.2g} % of the stiffest: {}",
                     each(modes).back().frequency_rad_per_s, 100.0 * share, verdict(share));
}

std::string modes_json(const StiffnessModes& modes) {
  std::vector<std::string> written;
  for (const controller::StiffnessMode& mode : each(modes)) {
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

std::vector<StiffnessReport> make_stiffness_reports(const Scenario& scenario,
                                                    const LoadedRobot& robot) {
  controller::ArmModel model(robot);
  controller::ArmTerms terms(model.size());
  const VectorJ q = Eigen::Map<const Eigen::VectorXd>(scenario.start_q.data(), model.size());
  model.evaluate(q, VectorJ::Zero(model.size()), &terms);
  compliance_gains_t present = default_gains(robot.robot);
  std::vector<StiffnessReport> reports{report(0.0, present, terms, robot.robot)};
  for (const TimedMessage& timed : scenario.timeline) {
    const auto* gains = std::get_if<compliance_gains_t>(&timed.message);
    if (gains == nullptr) continue;
    merge_gains(*gains, &present);
    reports.push_back(
        report(static_cast<double>(timed.time_ns) * 1e-9, present, terms, robot.robot));
  }
  return reports;
}

std::vector<std::string> stiffness_warnings(const std::vector<StiffnessReport>& reports,
                                            double rate_hz) {
  std::vector<std::string> warnings;
  for (const StiffnessReport& report : reports) {
    for (const auto& [name, modes] : {std::pair{"K_x", &report.tip}, {"K_q", &report.joints}}) {
      const double share = modes->highest_share();
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
