#include "controller/gains_request.h"

#include "controller/gains/read_gains.h"
#include "lcmtypes/gains_merge.h"
#include "robots/loader/default_gains.h"
#include "robots/loader/load_robot.h"

namespace limber::controller {

GainsRequest::GainsRequest(const LoadedRobot& robot, CycleParts* parts, Allowed allowed)
    : parts_(*parts),
      gains_check_(robot.robot.size(), allowed.demonstrations, law_catalog().parameters),
      stability_(1.0 / robot.robot.rate_hz, robot.robot.joint_names()),
      estimator_(robot.robot, parts->output.torque_limit()),
      unstable_allowed_(allowed.unstable_gains),
      accepted_fields_(limber::default_gains(robot.robot)),
      accepted_(parts->gains.target()),
      candidate_(accepted_) {}

Refusal GainsRequest::take(const compliance_gains_t& message) noexcept {
  compliance_gains_t fields =
      accepted_fields_;  // its strings and lists are empty: nothing is allocated
  merge_gains(message, &fields);
  law_ = message.law.empty() ? parts_.laws.selected() : find_law(message.law);
  const Refusal refusal = check(message, fields);
  if (refusal != nullptr) return refusal;
  accepted_fields_ = fields;
  accepted_ = candidate_;
  return refusal;
}

Refusal GainsRequest::check(const compliance_gains_t& message,
                            const compliance_gains_t& fields) noexcept {
  const CycleParts& p = parts_;
  if (const char* reason = gains_check_.check(message, fields))
    return {request_answer_t::REFUSED_GAINS_RANGE, reason};
  if (law_ < 0) return malformed("no control law has this name");
  const LawEntry& wanted = LawBank::entry(law_);
  candidate_ = accepted_;
  read_gains(fields, &candidate_);
  read_parameters(message, &candidate_.parameters, fields.num_joints);
  if (const char* reason = p.laws.check(law_, candidate_))
    return {request_answer_t::REFUSED_LAW, reason};
  if (const char* reason = parts_.gains.check_springs(candidate_, wanted, p.goals.goal(), p.arm)) {
    return {request_answer_t::REFUSED_SPRINGS, reason};
  }
  if (const char* reason = estimator_.check(candidate_.settings, p.arm.terms()))
    return {request_answer_t::REFUSED_GAINS_RANGE, reason};
  return check_stability(candidate_, wanted);
}

Refusal GainsRequest::check_stability(const Gains& gains, const LawEntry& law) noexcept {
  const ArmView& arm = parts_.arm;
  const char* unstable = nullptr;
  const char* undamped = nullptr;
  if (arm.elastic() == nullptr) {
    unstable = stability_.check(gains, arm.terms());
  } else {
    JointElasticity elastic = *arm.elastic();
    elastic.K_J = arm.springs().at_rest();
    elastic.position = arm.resolve(gains.settings.position_feedback, law.potential);
    const Gains here = parts_.gains.here(gains, law, parts_.goals.goal(), arm);
    unstable = stability_.check(here, arm.terms(), &elastic);
    undamped = damping_.check(here, law, arm.terms(), elastic);
  }
  if (unstable != nullptr && !unstable_allowed_)
    return {request_answer_t::REFUSED_UNSTABLE, unstable};
  return {.warning = unstable != nullptr ? unstable : undamped};
}

}  // namespace limber::controller
