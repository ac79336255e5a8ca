#include "sim/nodes/moteus_node.h"

#include <algorithm>
#include <cmath>
#include <limber/scenario_event_t.hpp>
#include <numbers>

#include "sim/nodes/encoder_counts.h"

namespace limber::sim {
namespace {

using moteus::Mode;
using moteus::Register;

constexpr double kTurn_rad = 2.0 * std::numbers::pi;  // rad
constexpr std::int64_t kEnablingMode_ns = 1'000'000;  // in each of modes 2, 3, 4
// Fault codes.
constexpr int kDriverFault = 33;
constexpr int kNotConfigured = 36;
constexpr int kOutsideLimits = 39;
constexpr int kStopPosition = 45;

}  // namespace

MoteusNode::MoteusNode(const JointConfig& joint)
    : drive_(joint.drive),
      settings_(joint.drive, moteus::address_of(joint.drive.command_id).destination) {}

MoteusNode::Sensed MoteusNode::sense(const JointReading& joint) const noexcept {
  const double torque = drive_.sign * joint.motor_torque;
  if (has(scenario_event_t::FAULT_FROZEN_ENCODER)) return {frozen_turns_, 0.0, torque};
  const double counts = drive_.counts_per_turn;
  const double turns = (drive_.sign * joint.theta + drive_.offset_rad) / kTurn_rad;
  return {whole_counts(turns * counts) / counts + zero_turns_,
          drive_.sign * joint.theta_dot / kTurn_rad, torque};
}

// --- frames --------------------------------------------------------------------------------------

bool MoteusNode::receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
                         CanFrame* reply) noexcept {
  pass_time(now_ns);
  if (frame.remote || frame.error) return false;
  const moteus::Address to = moteus::address_of(frame.id);
  if (to.prefix != 0 || (to.destination != id() && to.destination != moteus::kBroadcast))
    return false;
  moteus::FrameWriter answer(moteus::can_id({id(), to.source, false, 0}));
  moteus::FrameReader reader(frame);
  moteus::Subframe subframe;
  Request request;
  request.answered = to.reply_wanted;
  while (reader.next(&subframe)) work(subframe, joint, &request, &answer);
  for (std::size_t i = 0; i < request.refused_count; ++i)
    answer.write_error(request.refused[i].reg, request.refused[i].error);
  *reply = answer.frame();
  reply->fd = frame.fd || reply->length > 8;
  reply->bitrate_switch = frame.bitrate_switch;
  if (request.wanted) change_mode(request.mode, joint);
  std::string_view line;
  while (text_.line(&line)) execute(line, joint);
  return to.reply_wanted && !has(scenario_event_t::FAULT_SILENT);
}

void MoteusNode::work(const moteus::Subframe& subframe, const JointReading& joint, Request* request,
                      moteus::FrameWriter* answer) noexcept {
  using Kind = moteus::Subframe::Kind;
  const bool deaf = has(scenario_event_t::FAULT_DROP_COMMANDS);
  if (subframe.kind == Kind::kRead) answer_read(subframe, joint, answer);
  if (subframe.kind == Kind::kWrite && !deaf) {
    for (unsigned i = 0; i < subframe.count; ++i)
      write(static_cast<std::uint16_t>(subframe.first + i), subframe.value(i), joint, request);
  }
  const bool text = subframe.kind == Kind::kTextToDrive || subframe.kind == Kind::kTextPoll;
  if (!text || subframe.first != moteus::kTextChannel) return;
  const std::size_t most = subframe.kind == Kind::kTextPoll ? subframe.count : moteus::kMostText;
  if (request->answered)
    answer->text_from_drive(text_.read(std::min(most, answer->room_for_text())));
  if (subframe.kind == Kind::kTextToDrive && !deaf) text_.take(subframe.text());
}

// --- modes ---------------------------------------------------------------------------------------

void MoteusNode::change_mode(Mode wanted, const JointReading& joint) noexcept {
  if (wanted == Mode::kStopped) {
    if (!has(scenario_event_t::FAULT_DRIVE_ERROR)) leave(Mode::kStopped, 0);
    return;
  }
  if (mode_ == Mode::kFault || mode_ == Mode::kTimeout) return;
  if (wanted != Mode::kPosition && wanted != Mode::kZeroVelocity && wanted != Mode::kBrake)
    return leave(Mode::kFault, kNotConfigured);
  if (std::isfinite(written_.get(Register::kCommandStopPosition)))
    return leave(Mode::kFault, kStopPosition);
  command_ = written_;
  command_ns_ = now_ns_;
  next_mode_ = wanted;
  if (mode_ == Mode::kStopped) {
    mode_ = Mode::kEnabling;
    enabling_ns_ = now_ns_;
  } else if (mode_ == Mode::kPosition && wanted == Mode::kPosition) {
    aim();
  } else if (mode_ >= Mode::kPosition) {
    enter(wanted, joint);
  }
}

void MoteusNode::enter(Mode mode, const JointReading& joint) noexcept {
  mode_ = mode;
  if (mode != Mode::kPosition) return;
  const double here = sense(joint).turns;
  if (here < settings_[Setting::kPositionMin] || here > settings_[Setting::kPositionMax])
    return leave(Mode::kFault, kOutsideLimits);
  setpoint_.start(here, 0.0);
  aim();
}

/// Limits that a command leaves out are the configured ones.
void MoteusNode::aim() noexcept {
  const auto limit = [this](Register reg, Setting setting) {
    const double commanded = command_.get(reg);
    return std::isnan(commanded) ? settings_[setting] : commanded;
  };
  setpoint_.aim({command_.get(Register::kCommandPosition), command_.get(Register::kCommandVelocity),
                 limit(Register::kCommandVelocityLimit, Setting::kVelocityLimit),
                 limit(Register::kCommandAccelerationLimit, Setting::kAccelerationLimit)});
  setpoint_.keep_within(settings_[Setting::kPositionMin], settings_[Setting::kPositionMax]);
}

void MoteusNode::leave(Mode mode, int fault) noexcept {
  mode_ = mode;
  fault_ = fault;
  command_.reset();
}

bool MoteusNode::is_watched() const noexcept {
  return (mode_ >= Mode::kEnabling && mode_ <= Mode::kPosition) || mode_ == Mode::kZeroVelocity;
}

double MoteusNode::watchdog_s() const noexcept {
  const double asked = command_.get(Register::kCommandWatchdog);
  return asked == 0.0 ? settings_[Setting::kDefaultTimeout] : asked;
}

void MoteusNode::pass_time(std::int64_t now_ns) noexcept {
  const double passed_s = static_cast<double>(now_ns - now_ns_) * 1e-9;
  now_ns_ = now_ns;
  if (mode_ != Mode::kPosition) return;
  setpoint_.advance(passed_s);
  setpoint_.keep_within(settings_[Setting::kPositionMin], settings_[Setting::kPositionMax]);
}

void MoteusNode::update(const JointReading& joint, std::int64_t now_ns) noexcept {
  pass_time(now_ns);
  // NaN never expires.
  if (is_watched() && static_cast<double>(now_ns - command_ns_) * 1e-9 > watchdog_s())
    return leave(Mode::kTimeout, 0);
  if (mode_ >= Mode::kEnabling && mode_ < Mode::kPosition) {
    const std::int64_t steps = (now_ns - enabling_ns_) / kEnablingMode_ns;
    mode_ = static_cast<Mode>(2 + std::min<std::int64_t>(steps, 2));
    if (steps >= 3) enter(next_mode_, joint);
  }
}

double MoteusNode::kp() const noexcept { return settings_[Setting::kKp] / kTurn_rad; }
double MoteusNode::kd() const noexcept { return settings_[Setting::kKd] / kTurn_rad; }

DriveLaw MoteusNode::law() const noexcept {
  DriveLaw law;
  if (mode_ == Mode::kBrake) law.passive_damping = drive_.short_circuit_damping_Nms;
  const bool braked = settings_[Setting::kTimeoutMode] != static_cast<double>(Mode::kStopped);
  if (mode_ == Mode::kZeroVelocity || (mode_ == Mode::kTimeout && braked)) {
    const bool commanded = mode_ == Mode::kZeroVelocity;
    law.kd = kd() * (commanded ? command_.get(Register::kCommandKdScale) : 1.0);
    law.limit = std::min(drive_.peak_torque_Nm, settings_[Setting::kTimeoutTorque]);
  }
  if (mode_ != Mode::kPosition) return law;
  const double most = command_.get(Register::kCommandMaxTorque);
  const double kp = this->kp() * command_.get(Register::kCommandKpScale);
  const double kd = this->kd() * command_.get(Register::kCommandKdScale);
  const double speed = kTurn_rad * setpoint_.velocity();
  law.limit = most >= 0.0 ? std::min(drive_.peak_torque_Nm, most) : drive_.peak_torque_Nm;
  law.tau_ff = drive_.sign * command_.get(Register::kCommandTorque);
  if (has(scenario_event_t::FAULT_FROZEN_ENCODER)) {
    // The loop runs on the frozen reading, which no longer depends on the joint.
    law.tau_ff +=
        drive_.sign * (kp * kTurn_rad * (setpoint_.position() - frozen_turns_) + kd * speed);
    return law;
  }
  law.kp = kp;
  law.kd = kd;
  law.q_des = drive_.sign * (kTurn_rad * (setpoint_.position() - zero_turns_) - drive_.offset_rad);
  law.v_des = drive_.sign * speed;
  return law;
}

// --- faults --------------------------------------------------------------------------------------

void MoteusNode::on_fault(int fault, const JointReading& joint) noexcept {
  if (fault == scenario_event_t::FAULT_FROZEN_ENCODER) frozen_turns_ = sense(joint).turns;
  if (fault == scenario_event_t::FAULT_DRIVE_ERROR) leave(Mode::kFault, kDriverFault);
}

}  // namespace limber::sim
