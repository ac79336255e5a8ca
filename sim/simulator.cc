#include "sim/simulator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/config_error.h"
#include "drivers/can/lockstep_frame.h"
#include "sim/arm_plant.h"
#include "sim/force_model.h"
#include "sim/inbox.h"
#include "sim/motor_nodes.h"
#include "sim/start_state.h"
#include "sim/tick_count.h"
#include "sim/tip_sensor.h"
#include "sim/truth.h"
#include "sim/world_event.h"

namespace limber {
namespace {

/// Frames handled in one call of poll(), so that a flood cannot hold up time.
constexpr int kMostFrames = 4096;
/// Arm times beyond a year are nobody's TICK.
constexpr std::int64_t kLongest_ns = 366LL * 86400 * 1'000'000'000;

template <typename... Args>
[[noreturn]] void refuse(const Robot& robot, fmt::format_string<Args...> text, Args&&... args) {
  throw ConfigError(robot.name + ": " + fmt::format(text, std::forward<Args>(args)...));
}

void check_bus(const Robot& robot, const JointConfig& joint, int bus) {
  if (bus >= 0 && bus < static_cast<int>(robot.buses.size())) return;
  refuse(robot, "joint {} is on bus number {}, which does not exist", joint.name, bus);
}

void check(const Robot& robot, const std::vector<CanBus*>& buses, const SimulatorOptions& options) {
  if (!robot.has_drives)
    refuse(robot, "has no drives (no robot.yaml), so there is nothing to simulate on a bus");
  if (robot.size() < 1 || robot.size() > kMaxJoints) {
    refuse(robot, "has {} joints; 1 to {} are allowed", robot.size(), kMaxJoints);
  }
  if (buses.size() != robot.buses.size() || buses.empty() || buses.size() > kMaxBuses) {
    refuse(robot, "needs its {} buses, 1 to {} are allowed, {} given", robot.buses.size(),
           kMaxBuses, buses.size());
  }
  if (!(options.step_s >= 1e-6 && options.step_s <= 0.01)) {
    refuse(robot, "integration step {} s; allowed: 1e-6 to 0.01", options.step_s);
  }
  if (!(robot.rate_hz >= 1.0 && robot.rate_hz <= 1e5))
    refuse(robot, "rate {} Hz; allowed: 1 to 1e5", robot.rate_hz);
  if (robot.has_tip_sensor && !(robot.tip_sensor.bus < static_cast<int>(buses.size())))
    refuse(robot, "the tip sensor is on bus number {}, which does not exist", robot.tip_sensor.bus);
  for (const JointConfig& joint : robot.joints) {
    check_bus(robot, joint, joint.drive.bus);
    if (joint.has_antagonist) check_bus(robot, joint, joint.antagonist.bus);
  }
}

void check_reality(const Robot& robot, const Robot& reality) {
  bool same = robot.size() == reality.size() && robot.has_tip_sensor == reality.has_tip_sensor;
  for (int i = 0; same && i < robot.size(); ++i) {
    same = robot.joints[i].has_antagonist == reality.joints[i].has_antagonist;
  }
  if (!same)
    refuse(robot, "its reality has other joints, motors or tip sensor; the same are needed");
}

VectorJ start_position(const Robot& robot, const std::vector<double>& start_q) {
  if (!start_q.empty() && static_cast<int>(start_q.size()) != robot.size()) {
    refuse(robot, "the start has {} joints, the robot {}", start_q.size(), robot.size());
  }
  VectorJ q(robot.size());
  for (int i = 0; i < robot.size(); ++i) {
    const JointConfig& joint = robot.joints[i];
    q[i] = start_q.empty() ? joint.home : start_q[i];
    if (!(q[i] >= joint.position_min && q[i] <= joint.position_max) || !std::isfinite(q[i])) {
      refuse(robot, "start of {} at {}; allowed: {} to {}", joint.name, q[i], joint.position_min,
             joint.position_max);
    }
  }
  return q;
}

const LoadedRobot& real(const LoadedRobot& robot, const SimulatorOptions& options) {
  return options.reality != nullptr ? *options.reality : robot;
}

}  // namespace

struct Simulator::Impl {
  Impl(const LoadedRobot& robot, const std::vector<CanBus*>& buses,
       const SimulatorOptions& options);

  bool poll() noexcept;
  void on_frame(int bus, const CanFrame& frame) noexcept;
  bool on_tick(int bus, std::int64_t number) noexcept;
  void advance_step() noexcept;
  void update_stand(std::int64_t now_ns) noexcept;
  void apply_timeline(std::int64_t time_ns) noexcept;
  void apply(const ScenarioMessage& message) noexcept;
  void clear_world() noexcept;
  bool push(const push_t& message) noexcept;
  bool event(const scenario_event_t& message) noexcept;
  void set_payload(double mass, const Eigen::Vector3d& p_TL) noexcept;
  void inject(const sim::NodeFault& fault) noexcept;
  void update_tip_sensor(double h, std::int64_t t_ns) noexcept;
  std::int64_t sim_time(std::int64_t steps) const noexcept;
  std::int64_t arm_time_now() const noexcept;

  std::unique_ptr<sim::ArmPlant> plant;
  sim::ForceModel forces;
  sim::MotorNodes nodes;
  std::optional<sim::TipSensor> tip_sensor;
  std::vector<sim::Inbox> inboxes;
  sim::TickCount ticks;
  bool lockstep;
  bool stand;
  sim::StandFade stand_fade;

  std::int64_t period_ns;
  std::int64_t steps_per_period;
  double step_s;
  std::int64_t steps = 0;

  // Arm time was arm_anchor_ns when simulated time was sim_anchor_ns.
  bool arm_time_known = false;
  std::int64_t arm_anchor_ns = 0;
  std::int64_t sim_anchor_ns = 0;

  const std::vector<TimedMessage>* messages = nullptr;
  Timeline timeline{nullptr};
  std::int64_t refused = 0;
  sim_truth_t truth{};
};

Simulator::Impl::Impl(const LoadedRobot& robot, const std::vector<CanBus*>& buses,
                      const SimulatorOptions& options)
    : forces(real(robot, options).robot, robot.robot, options.friction),
      nodes(robot.robot, real(robot, options).robot),
      ticks(static_cast<int>(buses.size())),
      lockstep(options.lockstep),
      stand(options.stand) {
  const double period_s = 1.0 / robot.robot.rate_hz;
  period_ns = std::llround(1e9 * period_s);
  steps_per_period = nodes.steps_per_period(robot.robot.rate_hz, options.step_s);
  step_s = period_s / static_cast<double>(steps_per_period);

  const LoadedRobot& arm = real(robot, options);
  plant = sim::make_arm_plant(options.integrator, sim::build_arm_model(arm));
  sim::start_at(arm.robot, start_position(arm.robot, options.start_q), stand, plant.get());
  for (CanBus* bus : buses) inboxes.emplace_back(bus);
  if (arm.robot.has_tip_sensor) {
    tip_sensor.emplace(arm.robot.tip_sensor, plant->arm());
    update_tip_sensor(step_s, 0);
  }
  if (stand) sim::set_stands(arm.robot, plant->state(), &forces);
}

std::int64_t Simulator::Impl::sim_time(std::int64_t after_steps) const noexcept {
  return after_steps / steps_per_period * period_ns +
         after_steps % steps_per_period * period_ns / steps_per_period;
}

std::int64_t Simulator::Impl::arm_time_now() const noexcept {
  return arm_anchor_ns + (sim_time(steps) - sim_anchor_ns);
}

bool Simulator::Impl::poll() noexcept {
  int left = kMostFrames;
  for (int bus = 0; bus < static_cast<int>(inboxes.size()); ++bus) {
    while (const CanFrame* frame = inboxes[bus].next()) {
      if (lockstep && lockstep::is_tick(*frame)) {
        if (on_tick(bus, lockstep::sequence(*frame))) return true;
      } else {
        on_frame(bus, *frame);
      }
      if (--left == 0) return false;
    }
  }
  return false;
}

void Simulator::Impl::on_frame(int bus, const CanFrame& frame) noexcept {
  nodes.receive(bus, frame, forces, plant->state(), sim_time(steps), inboxes[bus].bus());
  if (!tip_sensor || tip_sensor->bus != bus) return;
  const std::span<const CanFrame> answer = tip_sensor->node.receive(frame);
  if (!answer.empty()) inboxes[bus].bus()->send(answer);
}

bool Simulator::Impl::on_tick(int bus, std::int64_t number) noexcept {
  switch (ticks.tick(bus, number)) {
    case sim::TickCount::Verdict::kWait:
      return false;
    case sim::TickCount::Verdict::kRepeated:
      inboxes[bus].bus()->send(lockstep::tock(number));
      return false;
    case sim::TickCount::Verdict::kAdvance:
      break;
  }
  if (ticks.falls()) clear_world();
  arm_time_known = true;
  arm_anchor_ns = std::clamp<std::int64_t>(number, 0, kLongest_ns / period_ns) * period_ns;
  sim_anchor_ns = sim_time(steps);
  apply_timeline(arm_anchor_ns);
  for (std::int64_t i = 0; i < steps_per_period; ++i) advance_step();
  for (const sim::Inbox& inbox : inboxes) inbox.bus()->send(lockstep::tock(number));
  return true;
}

void Simulator::Impl::advance_step() noexcept {
  nodes.command(&forces);
  const std::int64_t now = sim_time(steps);
  const std::int64_t next = sim_time(steps + 1);
  if (stand) update_stand(now);
  forces.environment.pushes.drop_finished(now);
  // Pushes change slowly against a step: their value in its middle stands for all of it.
  plant->step(&forces, step_s, now + (next - now) / 2);
  ++steps;
  nodes.update(forces, plant->state(), step_s, next, inboxes);
  if (tip_sensor) update_tip_sensor(step_s, next);
}

void Simulator::Impl::update_tip_sensor(double h, std::int64_t t_ns) noexcept {
  tip_sensor->update(plant->arm(), forces.environment, h, t_ns);
}

void Simulator::Impl::update_stand(std::int64_t now_ns) noexcept {
  const double left = stand_fade.left(now_ns, nodes.all_enabled());
  forces.set_stands_left(left);
  stand = left > 0.0;
}

void Simulator::Impl::apply_timeline(std::int64_t time_ns) noexcept {
  while (const ScenarioMessage* message = timeline.due(time_ns)) apply(*message);
}

void Simulator::Impl::apply(const ScenarioMessage& message) noexcept {
  bool done = true;
  if (const auto* a_push = std::get_if<push_t>(&message)) done = push(*a_push);
  if (const auto* an_event = std::get_if<scenario_event_t>(&message)) done = event(*an_event);
  if (!done) ++refused;
}

void Simulator::Impl::clear_world() noexcept {
  timeline.rewind();
  if (messages == nullptr) return;
  forces.environment.wall = sim::Wall();
  forces.environment.pushes.clear();
  set_payload(0.0, Eigen::Vector3d::Zero());
  nodes.clear_faults();
  if (tip_sensor) tip_sensor->node.clear_faults();
}

bool Simulator::Impl::push(const push_t& message) noexcept {
  sim::Push push;
  return sim::read_push(message, plant->arm().model(), &push) &&
         forces.environment.pushes.add(push, sim_time(steps));
}

bool Simulator::Impl::event(const scenario_event_t& message) noexcept {
  sim::Payload payload;
  sim::NodeFault fault;
  switch (message.kind) {
    case scenario_event_t::EVENT_WALL:
      return sim::read_wall(message, &forces.environment.wall);
    case scenario_event_t::EVENT_PAYLOAD:
      if (!sim::read_payload(message, &payload)) return false;
      set_payload(payload.mass, payload.p_TL);
      return true;
    case scenario_event_t::EVENT_FAULT:
      if (!sim::read_fault(message, plant->arm().size(), tip_sensor.has_value(), &fault))
        return false;
      inject(fault);
      return true;
    default:
      return false;
  }
}

void Simulator::Impl::set_payload(double mass, const Eigen::Vector3d& p_TL) noexcept {
  plant->set_payload(mass, p_TL);
  if (tip_sensor) tip_sensor->load.set_payload(plant->arm(), mass, p_TL);
}

void Simulator::Impl::inject(const sim::NodeFault& fault) noexcept {
  constexpr std::int64_t kForEver = std::numeric_limits<std::int64_t>::max();
  const std::int64_t now = sim_time(steps);
  const std::int64_t until =
      fault.duration_ns > kForEver - now ? kForEver : now + fault.duration_ns;
  if (fault.joint == scenario_event_t::NODE_TIP_SENSOR) {
    tip_sensor->node.silence(until);
  } else {
    nodes.inject(fault.joint, fault.fault, forces, plant->state(), until);
  }
}

Simulator::Simulator(const LoadedRobot& robot, std::vector<CanBus*> buses,
                     const SimulatorOptions& options) {
  check(robot.robot, buses, options);
  if (options.reality != nullptr) check_reality(robot.robot, options.reality->robot);
  impl_ = std::make_unique<Impl>(robot, buses, options);
}

Simulator::~Simulator() = default;

bool Simulator::poll() noexcept { return impl_->poll(); }

void Simulator::advance_to(std::int64_t sim_time_ns) noexcept {
  while (next_step_ns() <= sim_time_ns) {
    if (impl_->arm_time_known) impl_->apply_timeline(impl_->arm_time_now());
    impl_->advance_step();
  }
}

std::int64_t Simulator::sim_time_ns() const noexcept { return impl_->sim_time(impl_->steps); }
std::int64_t Simulator::next_step_ns() const noexcept { return impl_->sim_time(impl_->steps + 1); }
std::int64_t Simulator::periods() const noexcept { return impl_->steps / impl_->steps_per_period; }

std::int64_t Simulator::arm_time_ns() const noexcept {
  return impl_->lockstep ? impl_->arm_anchor_ns : impl_->arm_time_now();
}

void Simulator::set_arm_time_ns(std::int64_t time_ns) noexcept {
  impl_->arm_time_known = true;
  impl_->arm_anchor_ns = time_ns;
  impl_->sim_anchor_ns = sim_time_ns();
}

void Simulator::set_timeline(const std::vector<TimedMessage>* timeline) noexcept {
  impl_->messages = timeline;
  impl_->timeline = Timeline(timeline);
}

void Simulator::restart_timeline() noexcept { impl_->clear_world(); }
bool Simulator::push(const push_t& push) noexcept { return impl_->push(push); }
bool Simulator::event(const scenario_event_t& event) noexcept { return impl_->event(event); }
std::int64_t Simulator::refused() const noexcept { return impl_->refused; }

const sim_truth_t& Simulator::truth() noexcept {
  sim_truth_t& truth = impl_->truth;
  truth.seq = periods();
  truth.sim_time_ns = sim_time_ns();
  truth.time_ns = impl_->arm_time_known ? impl_->arm_time_now() : 0;
  sim::fill_truth(impl_->forces, truth.sim_time_ns, impl_->plant.get(), &truth);
  return truth;
}

std::int64_t Simulator::diverged() const noexcept { return impl_->plant->diverged(); }

}  // namespace limber
