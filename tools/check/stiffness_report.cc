#include "tools/check/stiffness_report.h"

#include <fmt/format.h>

#include <cmath>
#include <span>
#include <variant>

#include "controller/gains/read_gains.h"
#include "controller/kinds/gains.h"
#include "controller/model/arm_terms.h"
#include "lcmtypes/gains_merge.h"
#include "robots/loader/default_gains.h"
#include "tools/check/json.h"

namespace limber {
namespace {

using controller::PositionFeedback;
using controller::StiffnessModes;

constexpr double kClose = 0.5;

class StartPose {
 public:
  StartPose(const Scenario& scenario, const LoadedRobot& robot)
      : robot_(robot.robot), terms_(robot_.size()), springs_(robot_) {
    controller::ArmModel model(robot);
    const VectorJ q = Eigen::Map<const Eigen::VectorXd>(scenario.start_q.data(), model.size());
    model.evaluate(q, VectorJ::Zero(model.size()), &terms_);
    gravity_gradient_ = model.gravity_gradient(q);
  }

  StiffnessReport report(double at_s, const compliance_gains_t& fields) const {
    controller::Gains gains(robot_.size(), {});
    controller::read_gains(fields, &gains);
    const double T = 1.0 / robot_.rate_hz;
    const StiffnessModes null_space = null_modes(gains, terms_, T);
    if (!springs_.any())
      return {at_s, tip_modes(gains, terms_, T), joint_modes(gains, terms_, T), null_space};
    controller::JointElasticity elastic(robot_, springs_);
    elastic.position = gains.settings.position_feedback;
    if (elastic.position == PositionFeedback::kAuto) elastic.position = PositionFeedback::kStatic;
    double asked = 0.0;
    if (elastic.position != PositionFeedback::kMotor) {
      const MatrixJ K = terms_.J.transpose() * gains.K_x * terms_.J;
      asked = controller::JointSprings::taken(K, elastic.K_J, gravity_gradient_);
      gains.K_x *= controller::JointSprings::allowed_share(K, elastic.K_J, gravity_gradient_);
      gains.K_q = controller::JointSprings::within(gains.K_q, elastic.K_J, gravity_gradient_);
    }
    return {at_s, tip_modes(gains, terms_, T, &elastic), joint_modes(gains, terms_, T, &elastic),
            null_space, asked};
  }

 private:
  const Robot& robot_;
  controller::ArmTerms terms_;
  controller::JointSprings springs_;
  MatrixJ gravity_gradient_;
};

std::span<const controller::StiffnessMode> each(const StiffnessModes& modes) {
  return std::span(modes.modes).first(static_cast<std::size_t>(modes.count));
}

std::string summary(const StiffnessModes& modes) {
  if (!(modes.damping_share <= 1.0))
    return fmt::format("damped {:.3g} times more than is stable", modes.damping_share);
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
  const StartPose pose(scenario, robot);
  compliance_gains_t present = default_gains(robot.robot);
  std::vector<StiffnessReport> reports{pose.report(0.0, present)};
  for (const TimedMessage& timed : scenario.timeline) {
    const auto* gains = std::get_if<compliance_gains_t>(&timed.message);
    if (gains == nullptr) continue;
    merge_gains(*gains, &present);
    reports.push_back(pose.report(static_cast<double>(timed.time_ns) * 1e-9, present));
  }
  return reports;
}

std::vector<std::string> stiffness_warnings(const std::vector<StiffnessReport>& reports,
                                            const Robot& robot) {
  const double rate_hz = robot.rate_hz;
  std::vector<std::string> warnings;
  for (const StiffnessReport& report : reports) {
    struct Judged {
      const char* spring;
      const char* damper;
      const StiffnessModes& modes;
    };
    for (const auto& [name, damper, modes] : {Judged{"K_x", "D_x", report.tip},
                                              {"K_q", "D_q", report.joints},
                                              {"K_null", "D_null", report.null_space}}) {
      if (!(modes.damping_share <= 1.0)) {
        warnings.push_back(fmt::format(
            "gains at {:g} s: {} is {:.3g} times what is stable at {:g} Hz at the start pose, "
            "most of it at {}",
            report.at_s, damper, modes.damping_share, rate_hz,
            robot.joints[static_cast<std::size_t>(modes.damped_joint)].name));
      }
      const double share = modes.highest_share();
      if (share <= 1.0) continue;
      const std::string much = std::isfinite(share)
                                   ? fmt::format("{:.3g} times what is stable", share)
                                   : "unstable with this damping, however soft it is,";
      warnings.push_back(fmt::format("gains at {:g} s: {} is {} at {:g} Hz at the start pose",
                                     report.at_s, name, much, rate_hz));
    }
    // What the timeline asks of the springs is among the requests that would be refused.
    if (report.at_s > 0.0 || report.springs <= 1.0) continue;
    warnings.push_back(fmt::format(
        "gains at {:g} s: K_x is {:.2g} % more than the joints' springs, less the weight, allow at "
        "the start pose: lower it, or choose position_feedback motor",
        report.at_s, 100.0 * (report.springs - 1.0)));
  }
  return warnings;
}

std::string stiffness_text(const std::vector<StiffnessReport>& reports, double rate_hz) {
  std::string text = fmt::format(
      "  modes at the start pose, against the stiffest that is stable at {:g} Hz:\n", rate_hz);
  for (const StiffnessReport& report : reports) {
    text += fmt::format("  {:8.3f} s  tip {}; joints {}; null space {}\n", report.at_s,
                        summary(report.tip), summary(report.joints), summary(report.null_space));
  }
  return text;
}

std::string stiffness_json(const std::vector<StiffnessReport>& reports) {
  std::vector<std::string> written;
  for (const StiffnessReport& report : reports) {
    written.push_back(json::object({{"at_s", json::number(report.at_s)},
                                    {"tip", modes_json(report.tip)},
                                    {"joints", modes_json(report.joints)},
                                    {"null_space", modes_json(report.null_space)}}));
  }
  return json::list(written);
}

}  // namespace limber
