#include "qa/faults/fault_stage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "robots/loader/protocols/drive_protocol.h"

namespace limber::faults {
namespace {

constexpr int kVerdicts = 16;  // room in driver_status_t
constexpr std::int64_t kHoldAt_ns = 300'000'000;
constexpr std::int64_t kActiveAt_ns = 1'100'000'000;
constexpr std::int64_t kCircleAt_ns = 1'200'000'000;

Scenario moving_arm(int joints) {
  Scenario scenario;
  scenario.name = "faults";
  scenario.wire.on = true;
  mode_request_t mode{};
  mode.client = kScenarioClient;
  mode.request = mode_request_t::REQUEST_HOLD;
  scenario.timeline.push_back({kHoldAt_ns, mode});
  mode.request = mode_request_t::REQUEST_ACTIVE;
  scenario.timeline.push_back({kActiveAt_ns, mode});
  compliance_goal_t circle{};
  circle.client = kScenarioClient;
  circle.kind = compliance_goal_t::GOAL_CIRCLE;
  circle.num_joints = static_cast<std::int8_t>(joints);
  circle.duration_s = 1.0;
  circle.offset[0] = 0.02;
  circle.offset[5] = 1.0;
  scenario.timeline.push_back({kCircleAt_ns, circle});
  return scenario;
}

template <typename Count>
std::int64_t sum(const Count* counts, int n) {
  return std::accumulate(counts, counts + n, std::int64_t{0});
}

Reaction counters(const driver_status_t& status) {
  Reaction out;
  out.lost = sum(status.replies_lost, status.num_joints);
  out.late = sum(status.replies_late, status.num_joints);
  out.invalid = sum(status.replies_invalid, status.num_joints);
  out.foreign = sum(status.frames_foreign, status.num_buses);
  out.refused = sum(status.commands_refused, kVerdicts);
  return out;
}

/// Of the refusals between the two.
int most_frequent_verdict(const driver_status_t& before, const driver_status_t& after) {
  std::array<std::int64_t, kVerdicts> counts{};
  for (std::size_t i = 0; i < kVerdicts; ++i)
    counts[i] = after.commands_refused[i] - before.commands_refused[i];
  return static_cast<int>(std::ranges::max_element(counts) - counts.begin());
}

void note_motion(const sim_truth_t& start, const sim_truth_t& now, Reaction* reaction) {
  for (int i = 0; i < now.num_joints; ++i) {
    reaction->moved_rad = std::max(reaction->moved_rad, std::abs(now.q[i] - start.q[i]));
    reaction->speed_rad_per_s = std::max(reaction->speed_rad_per_s, std::abs(now.v[i]));
  }
}

}  // namespace

FaultStage::FaultStage(const LoadedRobot& robot, const LoadedRobot* simulated,
                       std::int64_t first_cycle)
    : robot_(robot), scenario_(moving_arm(robot.robot.size())) {
  const auto begin_ns =
      static_cast<std::int64_t>(static_cast<double>(first_cycle) * 1e9 / robot.robot.rate_hz);
  for (TimedMessage& message : scenario_.timeline) message.time_ns += begin_ns;
  const auto tamper = [this](CanBus* end) {
    auto bus = std::make_unique<TamperedBus>(end);
    tampered_.push_back(bus.get());
    return bus;
  };
  const auto before_gate = [this](const joint_command_t& answer, auto* instead) {
    if (answer_change_) {
      answer_change_(answer, instead);
    } else {
      instead->push_back(answer);
    }
  };
  lab_ = std::make_unique<Lab>(robot, scenario_,
                               LabOptions{simulated, tamper, before_gate, first_cycle});
  outside_ = lab_->attach();
  family_ = make_drive_family(joint(), bus_config().fd, 1.0 / robot.robot.rate_hz);
}

const BusConfig& FaultStage::bus_config() const {
  return robot_.robot.buses[static_cast<std::size_t>(joint().drive.bus)];
}

bool has_kind(const CanFrame& frame, const DriveConfig& drive, std::uint32_t id) noexcept {
  CanFrame of_kind = frame;
  of_kind.id = kind_of_id(drive, frame.id, frame.extended);
  return has_id(of_kind, id);
}

bool FaultStage::is_mine(const CanFrame& frame) const {
  const DriveConfig& drive = joint().drive;
  for (std::size_t i = 0; i < drive.frames.replies.size(); ++i) {
    if (has_kind(frame, drive, drive.reply(i)))
      return family_.codec->is_mine(frame) && !tells_setting(frame);
  }
  return false;
}

bool FaultStage::tells_setting(const CanFrame& frame) const {
  double found = 0.0;
  for (int i = 0; i < family_.startup->steps(); ++i) {
    if (family_.startup->can_be_polled(i) &&
        family_.startup->check_answer(i, frame, &found) != limber::Answer::kNone)
      return true;
  }
  return false;
}

void FaultStage::change_replies(TamperedBus::Change change) {
  bus().set_change([this, change = std::move(change)](const CanFrame& frame, auto* instead) {
    if (is_mine(frame)) {
      change(frame, instead);
    } else {
      instead->push_back(frame);
    }
  });
}

void FaultStage::send_from_outside(const CanFrame& frame) {
  outside_[static_cast<std::size_t>(joint().drive.bus)]->send(frame);
}

void FaultStage::step() {
  for (TamperedBus* bus : tampered_) bus->release();
  if (each_cycle_) each_cycle_();
  lab_->step();
  if (frames_) frames_->write_cycle(lab_->state().time_ns);
}

void FaultStage::record(const std::string& path) {
  frames_ = std::make_unique<FrameLog>(path, robot_.robot, lab_.get());
}

void FaultStage::run(int cycles) {
  while (lab_->cycles() < cycles) step();
}

bool FaultStage::on() const { return lab_->state().drive_state == joint_state_t::DRIVE_ON; }

bool FaultStage::moves() const { return on() && lab_->controller_status().requests_refused == 0; }

Reaction FaultStage::watch(int cycles) {
  const driver_status_t status_before = lab_->driver_status();
  const Reaction before = counters(status_before);
  bool was_on = on();
  const sim_truth_t start = lab_->truth();
  Reaction out;
  for (int i = 1; i <= cycles; ++i) {
    step();
    const joint_state_t& state = lab_->state();
    note_motion(start, lab_->truth(), &out);
    out.returned = out.returned || (out.cycles >= 0 && on());
    const bool left = was_on ? state.drive_state != joint_state_t::DRIVE_ON
                             : state.drive_state == joint_state_t::DRIVE_FAULT;
    was_on = was_on || on();
    if (on()) out.moved_on_rad = out.moved_rad;
    if (out.cycles < 0 && left) {
      out.cycles = i;
      out.state = state.drive_state;
      out.cause = state.fault;
      out.joint = state.fault_joint;
      const ArmDriver& driver = lab_->driver();
      out.text = state.fault == joint_state_t::FAULT_CONFIGURATION
                     ? driver.configuration_problem()
                     : driver.fault_text(state.fault, state.fault_joint, driver.fault_detail());
    }
    if (out.fault_cycles < 0 && state.drive_state == joint_state_t::DRIVE_FAULT)
      out.fault_cycles = i;
  }
  const Reaction after = counters(lab_->driver_status());
  out.lost = after.lost - before.lost;
  out.late = after.late - before.late;
  out.invalid = after.invalid - before.invalid;
  out.foreign = after.foreign - before.foreign;
  out.refused = after.refused - before.refused;
  out.verdict = most_frequent_verdict(status_before, lab_->driver_status());
  return out;
}

}  // namespace limber::faults
