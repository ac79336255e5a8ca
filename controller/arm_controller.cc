#include "controller/arm_controller.h"

#include <algorithm>
#include <filesystem>
#include <limits>

#include "common/clock.h"
#include "common/config_error.h"
#include "common/overloaded.h"
#include "controller/status_writer.h"
#include "lcmtypes/channels.h"
#include "robots/loader/load_robot.h"

namespace limber {
namespace {

using namespace controller;

// Steps of the torque that tau_gravity may make in a cycle; the gate lets three pass.
constexpr double kGravitySteps = 2.0;
constexpr Refusal kNoHand = {request_answer_t::REFUSED_NO_HAND, "robot.yaml has no `hand:`"};
constexpr std::int64_t kLongestStep = 3;  // periods
constexpr std::int64_t kStartPatience_ns = 5'000'000'000;

Activity activity_of(const Supervisor& supervisor) noexcept {
  if (!supervisor.engaged()) return Activity::kStandby;
  switch (supervisor.mode()) {
    case Mode::kActive:
      return Activity::kLaw;
    case Mode::kSoftStop:
      return Activity::kStop;
    default:
      return Activity::kHold;
  }
}

const LoadedRobot& controllable(const LoadedRobot& robot) {
  if (!robot.robot.has_drives) {
    throw ConfigError(robot.robot.name +
                      ": this robot has no drives (no robot.yaml), so there is " +
                      "nothing to control");
  }
  return robot;
}

bool is_simulated(const Robot& robot, const ArmControllerOptions& options) {
  return options.simulated || robot.on_virtual_buses();
}

TorqueCycle::Allowed allowed_on(const Robot& robot, const ArmControllerOptions& options) {
  const bool simulated = is_simulated(robot, options);
  return {.demonstrations = simulated, .unstable_gains = simulated && options.allow_unstable};
}

TorqueLimiter gravity_limiter(const Robot& robot) {
  VectorJ rate(robot.size());
  for (int i = 0; i < robot.size(); ++i)
    rate[i] = kGravitySteps * robot.joints[static_cast<std::size_t>(i)].torque_rate_limit_Nm_per_s;
  return {VectorJ::Constant(rate.size(), std::numeric_limits<double>::infinity()), rate};
}

robot_info_t info_of(const Robot& robot, std::int64_t controller, bool simulated) {
  robot_info_t info{};
  info.controller = controller;
  info.robot = robot.name;
  if (!robot.folder.empty())
    info.folder = std::filesystem::absolute(robot.folder).lexically_normal();
  info.rate_hz = robot.rate_hz;
  info.simulated = simulated ? 1 : 0;
  info.joints = robot.joint_names();
  info.num_joints = static_cast<std::int8_t>(info.joints.size());
  return info;
}

}  // namespace

ArmController::ArmController(const LoadedRobot& robot, const ArmControllerOptions& options)
    : options_(options),
      supervisor_(robot.robot.size(), options.bridged_cycles, equipment_of(robot.robot),
                  PreloadWatch(robot.robot)),
      cycle_(controllable(robot), options.law, allowed_on(robot.robot, options)),
      start_watch_(robot.robot),
      load_watch_(robot.robot),
      encoder_watch_(robot.robot),
      energy_watch_(robot.robot),
      gravity_limiter_(gravity_limiter(robot.robot)),
      info_(info_of(robot.robot, options.controller, is_simulated(robot.robot, options))) {
  if (robot.robot.hand) hand_.emplace(robot.robot, options.controller);
  answer_.controller = options.controller;
  answer_.num_joints = static_cast<std::int16_t>(robot.robot.size());
  status_.controller = options.controller;
}

const joint_command_t& ArmController::step(const joint_state_t& state) noexcept {
  const std::int64_t started_ns = options_.measure_time ? monotonic_ns() : 0;
  outcomes_.clear();
  const StateJudgement judgement = supervisor_.on_state(state);
  if (judgement.ignored()) return answer_;
  if (judgement.new_session && timeline_) timeline_->rewind();
  if (judgement.new_session || judgement.silent) cycle_.restart();
  if (judgement.usable) {
    period_s_ = static_cast<double>(state.period_ns) * 1e-9;
    cycle_.measure(state);
    if (hand_) hand_->measure(state);
    apply_timeline(state.time_ns);
  }

  // After a longer gap the goal goes on from where it was, not from where it would be.
  const std::int64_t periods = std::min(judgement.missed, kLongestStep - 1) + 1;
  const double dt_s = static_cast<double>(periods) * period_s_;
  // Before the torque: what they find must not make it step twice in a cycle.
  if (judgement.usable) watch_motion(state, dt_s);
  const Activity activity = activity_of(supervisor_);
  if (activity != Activity::kStandby && !cycle_.step(activity, dt_s))
    supervisor_.raise(Event::kTorqueInvalid);
  if (activity_of(supervisor_) == Activity::kStandby) cycle_.stand_by(standby());
  if (hand_) move_hand(activity_of(supervisor_), dt_s);

  write_answer(state);
  write_status(started_ns);
  return answer_;
}

void ArmController::watch_motion(const joint_state_t& state, double dt_s) noexcept {
  const bool engaged = supervisor_.engaged();
  if (!engaged) {
    encoder_watch_.reset();
    energy_watch_.reset();
    load_watch_.relax(dt_s);
  }
  if (engaged && !was_engaged_) {
    start_watch_.begin(state);
    load_watch_.begin();
  }
  if (supervisor_.mode() != Mode::kHold) {
    start_watch_.end();
    load_watch_.end();
  }
  was_engaged_ = engaged;
  if (!engaged) return;
  if (const int joint = start_watch_.strayed(state); joint >= 0)
    supervisor_.raise(Event::kStrayed, joint);
  const ArmTerms& terms = cycle_.terms();
  const LoadWatch::Model model{cycle_.gravity(), terms.Cv, terms.M,
                               terms.B,          terms.J,  cycle_.walls()};
  if (const int joint = load_watch_.wrong(state, model, dt_s); joint >= 0)
    supervisor_.raise(Event::kStrayed, joint);
  if (const int joint = load_watch_.overdriven(); joint >= 0)
    supervisor_.raise(Event::kOverdriven, joint);
  const EncoderWatch::Model arm{cycle_.gravity(), terms.CTv, terms.M_total};
  if (const int joint = encoder_watch_.stopped(state, arm, dt_s); joint >= 0)
    supervisor_.raise(Event::kEncoderStopped, joint);
  const EnergyWatch::Model bodies{cycle_.link_inertia(), terms.B, cycle_.link_gravity(),
                                  cycle_.spring_torque()};
  if (energy_watch_.exceeded(state, bodies, dt_s)) supervisor_.raise(Event::kEnergy);
}

void ArmController::set_timeline(const std::vector<TimedMessage>* timeline) {
  timeline_.emplace(timeline);
  outcomes_.reserve(timeline->size());
}

void ArmController::apply_timeline(std::int64_t time_ns) noexcept {
  if (!timeline_) return;
  while (const TimedMessage* next = timeline_->peek(time_ns)) {
    // A slow start of the drives or a busy machine must not cost the requests of a whole run.
    const auto* mode = std::get_if<mode_request_t>(&next->message);
    if (mode != nullptr && supervisor_.not_yet(*mode) &&
        time_ns - next->time_ns < kStartPatience_ns) {
      return;
    }
    std::visit(
        Overloaded{
            [&](const mode_request_t& m) { outcomes_.push_back(outcome_of(m, on_mode(m))); },
            [&](const compliance_goal_t& m) { outcomes_.push_back(outcome_of(m, on_goal(m))); },
            [&](const compliance_gains_t& m) { outcomes_.push_back(outcome_of(m, on_gains(m))); },
            [&](const target_stream_t& m) {
              if (const Refusal refusal = on_stream(m)) outcomes_.push_back(outcome_of(m, refusal));
            },
            [&](const hand_goal_t& m) { outcomes_.push_back(outcome_of(m, on_hand(m))); },
            [](const auto&) {},  // the simulator's
        },
        *timeline_->due(time_ns));
  }
}

Standby ArmController::standby() const noexcept {
  using Torque = Standby::Torque;
  const Mode mode = supervisor_.mode();
  const bool latched = mode == Mode::kFault || mode == Mode::kEstop;
  const bool on = supervisor_.drives_on();
  if (supervisor_.powered_mode()) {
    // The drives are still being enabled, without torque, or they hold by themselves. No wind-up.
    return {Torque::kAsSent, false, PreloadAtRest::kAsApplied};
  }
  if (latched || supervisor_.drives_carry()) {
    return {Torque::kGravity, on, PreloadAtRest::kAsApplied};
  }
  return {Torque::kZero, on, PreloadAtRest::kReleased};
}

// Where the arm's weight is reckoned at another point from one cycle to the next, as by a law that
// loses the links' static equilibrium, it jumps; the gate refuses jumps.
void ArmController::write_gravity() noexcept {
  VectorJ tau = load_watch_.carrying(cycle_.gravity());
  const bool first = answer_.session == 0;
  if (first) gravity_limiter_.set_previous(tau);
  gravity_limiter_.limit(period_s_, &tau);
  Eigen::Map<VectorJ>(answer_.tau_gravity, answer_.num_joints) = tau;
}

void ArmController::move_hand(Activity activity, double dt_s) noexcept {
  if (activity != Activity::kLaw) hand_knots_.end();
  if (std::optional<hand_goal_t> goal = hand_knots_.due(cycle_.time_ns())) {
    goal->width_m = hand_->within_travel(goal->width_m);
    hand_->set_goal(*goal);
  }
  if (activity != Activity::kStandby) return hand_->step(activity == Activity::kLaw, dt_s);
  using Rest = HandControl::Rest;
  switch (standby().torque) {
    case Standby::Torque::kZero:
      return hand_->stand_by(Rest::kNone, dt_s);
    case Standby::Torque::kAsSent:
      return hand_->stand_by(Rest::kApplied, dt_s);
    case Standby::Torque::kGravity:
      return hand_->stand_by(Rest::kKept, dt_s);
  }
}

void ArmController::write_answer(const joint_state_t& state) noexcept {
  write_gravity();
  answer_.state_seq = state.seq;
  answer_.time_ns = state.time_ns;
  answer_.session = state.session;
  answer_.request = supervisor_.drive_request();
  answer_.mode = static_cast<std::int8_t>(supervisor_.mode());
  const int n = answer_.num_joints;
  Eigen::Map<VectorJ>(answer_.tau, n) = cycle_.torque();
  Eigen::Map<VectorJ>(answer_.tau_preload, n) = cycle_.preload_torque();
  if (hand_) hand_->write(&answer_);
}

void ArmController::write_status(std::int64_t started_ns) noexcept {
  const bool published = answer_.state_seq % channels::kControllerStatusEvery == 0;
  if (published) ++status_.seq;
  if (answer_.state_seq % channels::kRobotInfoEvery == 0) ++info_.seq;
  info_.time_ns = status_.time_ns = answer_.time_ns;
  status_.session = answer_.session;
  status_.state_seq = answer_.state_seq;
  status_.mode = answer_.mode;
  status_.reason = supervisor_.reason();
  status_.reason_joint = static_cast<std::int8_t>(supervisor_.reason_joint());
  status_.states_received = supervisor_.states().received();
  status_.states_lost = supervisor_.states().lost();
  status_.unexplained_energy_J = energy_watch_.unexplained_J();
  controller::write_status(cycle_.trace(), &status_);
  write_stream();
  if (hand_ && published) hand_->write_state(status_.seq, status_.time_ns);
  if (!options_.measure_time) return;
  status_.cycle_ns = monotonic_ns() - started_ns;
  status_.cycle_max_ns = std::max(status_.cycle_max_ns, status_.cycle_ns);
}

void ArmController::write_stream() noexcept {
  const TargetStream& stream = cycle_.stream();
  const StreamCounts& counts = stream.counts();
  status_.stream = stream.state();
  status_.stream_delay_s = static_cast<float>(stream.delay_s());
  status_.stream_margin_s = static_cast<float>(stream.margin_s());
  status_.stream_taken = counts.taken;
  status_.stream_late = counts.late;
  status_.stream_stale = counts.stale;
  status_.stream_refused = counts.refused;
  status_.stream_starved = counts.starved;
  status_.overlays_taken = cycle_.overlay().taken();
  status_.overlays_expired = cycle_.overlay().expired();
}

Refusal ArmController::counted(Refusal refusal) noexcept {
  if (refusal) ++status_.requests_refused;
  return refusal;
}

Refusal ArmController::on_mode(const mode_request_t& request) noexcept {
  return counted(supervisor_.on_mode(request));
}

Refusal ArmController::check_active(std::int64_t client) const noexcept {
  if (const Refusal refusal = supervisor_.check_client(client)) return refusal;
  if (supervisor_.mode() != Mode::kActive)
    return {request_answer_t::REFUSED_MODE, "goals are accepted in ACTIVE only"};
  return {};
}

Refusal ArmController::on_goal(const compliance_goal_t& goal) noexcept {
  if (const Refusal refusal = check_active(goal.client)) return counted(refusal);
  const Refusal refusal = cycle_.set_goal(goal, activity_of(supervisor_));
  if (refusal) return counted(refusal);
  supervisor_.take_lease(goal.client);
  supervisor_.take_goal(goal.valid_for_s);
  return refusal;  // perhaps with a warning
}

Refusal ArmController::on_gains(const compliance_gains_t& gains) noexcept {
  if (const Refusal refusal = supervisor_.check_client(gains.client)) return counted(refusal);
  const Refusal refusal = cycle_.set_gains(gains, activity_of(supervisor_));
  if (refusal) return counted(refusal);
  supervisor_.take_lease(gains.client);
  return refusal;  // perhaps with a warning
}

Refusal ArmController::on_stream(const target_stream_t& stream) noexcept {
  const std::int64_t now_ns = cycle_.time_ns();
  Refusal refusal = check_active(stream.client);
  if (!refusal) refusal = check_hand(stream);
  if (!refusal) refusal = cycle_.set_stream(stream, activity_of(supervisor_));
  if (refusal) {
    cycle_.stream().count_refused();
    return counted(refusal);
  }
  supervisor_.take_lease(stream.client);
  if (TargetStream::stale(stream, now_ns)) return refusal;
  hand_knots_.take(stream, now_ns);
  const double left_s = 1e-9 * static_cast<double>(TargetStream::end_ns(stream, now_ns) - now_ns);
  const double valid_s = stream.valid_for_s;
  supervisor_.take_goal(valid_s > 0.0 ? valid_s + std::max(left_s, 0.0) : 0.0);
  return refusal;  // perhaps with a warning
}

Refusal ArmController::check_hand(const target_stream_t& stream) const noexcept {
  if (stream.use_hand == 0) return {};
  if (!hand_) return kNoHand;
  for (int i = 0; i < std::clamp<int>(stream.num_knots, 0, 16); ++i) {
    hand_goal_t goal{};
    goal.width_m = hand_->within_travel(static_cast<double>(stream.hand_width_m[i]));
    goal.force_N = static_cast<double>(stream.hand_force_N);
    if (const Refusal refusal = hand_->check(goal)) return refusal;
  }
  return {};
}

Refusal ArmController::on_overlay(const torque_overlay_t& overlay) noexcept {
  if (const Refusal refusal = check_active(overlay.client)) return counted(refusal);
  if (const Refusal refusal = cycle_.set_overlay(overlay)) return counted(refusal);
  supervisor_.take_lease(overlay.client);
  return {};
}

Refusal ArmController::on_hand(const hand_goal_t& goal) noexcept {
  if (!hand_) return counted(kNoHand);
  if (const Refusal refusal = check_active(goal.client)) return counted(refusal);
  if (const Refusal refusal = hand_->check(goal)) return counted(refusal);
  hand_knots_.end();
  hand_->set_goal(goal);
  supervisor_.take_lease(goal.client);
  return {};
}

void ArmController::on_silence() noexcept {
  supervisor_.forget_sequence();
  supervisor_.raise(Event::kStateLost);
  ++status_.seq;
  status_.mode = static_cast<std::int8_t>(supervisor_.mode());
  status_.reason = supervisor_.reason();
  status_.reason_joint = static_cast<std::int8_t>(supervisor_.reason_joint());
}

}  // namespace limber
