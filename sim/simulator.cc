#include "sim/simulator.h"

#include <algorithm>

#include "drivers/can/lockstep_frame.h"
#include "sim/plant/check_setup.h"
#include "sim/world/world_event.h"

namespace limber {
namespace {

/// Frames handled in one call of poll(), so that a flood cannot hold up time.
constexpr int kMostFrames = 4096;
/// No TICK stands for an arm time beyond a year.
constexpr std::int64_t kLongest_ns = 366LL * 86400 * 1'000'000'000;

/// The arm as it is.
const LoadedRobot& real(const LoadedRobot& robot, const SimulatorOptions& options) {
  return options.plant != nullptr ? *options.plant : robot;
}

sim::SimulatedArm checked_arm(const LoadedRobot& robot, std::size_t buses,
                              const SimulatorOptions& options) {
  const LoadedRobot& plant = real(robot, options);
  sim::check_setup(robot.robot, buses, options.step_s);
  sim::check_plant(robot.robot, plant.robot);
  return {plant,
          robot.robot,
          options.integrator,
          options.friction,
          sim::start_position(plant.robot, options.start_q),
          options.stand,
          options.objects};
}

}  // namespace

Simulator::Simulator(const LoadedRobot& robot, std::vector<CanBus*> buses,
                     const SimulatorOptions& options)
    : lockstep_(options.lockstep),
      arm_(checked_arm(robot, buses.size(), options)),
      nodes_(robot.robot, real(robot, options).robot, arm_),
      clock_(robot.robot.rate_hz, nodes_.steps_per_period(robot.robot.rate_hz, options.step_s)),
      ticks_(static_cast<int>(buses.size())) {
  WireOptions wire = options.wire;
  wire.on = wire.on && lockstep_;
  for (std::size_t b = 0; b < buses.size(); ++b)
    buses_.emplace_back(buses[b], robot.robot.buses[b], wire, nodes_.size(), b);
  nodes_.update_tip_sensor(arm_, clock_.step_s(), 0);
}

// --- time ----------------------------------------------------------------------------------------

bool Simulator::poll() noexcept {
  const bool advanced = handle_frames();
  deliver();
  return advanced;
}

void Simulator::deliver() noexcept {
  for (sim::BusSide& side : buses_) side.deliver();
}

bool Simulator::handle_frames() noexcept {
  int left = kMostFrames;
  for (int bus = 0; bus < static_cast<int>(buses_.size()); ++bus) {
    while (const CanFrame* frame = buses_[bus].next()) {
      if (lockstep_ && lockstep::is_tick(*frame)) {
        if (on_tick(bus, lockstep::sequence(*frame))) return true;
      } else if (buses_[bus].has_wire()) {
        buses_[bus].accept(*frame, clock_.now_ns());
      } else {
        nodes_.receive(bus, *frame, clock_.now_ns(), &buses_[bus]);
      }
      if (--left == 0) return false;
    }
  }
  return false;
}

// What waits in the driver's adapter, without time.
void Simulator::flush(int bus) noexcept {
  sim::BusSide& side = buses_[bus];
  CanFrame frame;
  side.set_direct(true);
  while (side.has_wire() && side.take_waiting(&frame))
    nodes_.receive(bus, frame, clock_.now_ns(), &side);
  nodes_.send_pending_of(bus, clock_.now_ns(), &side);
  side.set_direct(false);
  side.clear();
}

bool Simulator::on_tick(int bus, std::int64_t number) noexcept {
  if (number == lockstep::kStandstill) {
    flush(bus);
    return false;
  }
  switch (ticks_.tick(bus, number)) {
    case sim::TickCount::Verdict::kWait:
      return false;
    case sim::TickCount::Verdict::kRepeated:
      buses_[bus].send_directly(lockstep::tock(number));
      return false;
    case sim::TickCount::Verdict::kAdvance:
      break;
  }
  if (ticks_.falls()) {
    restart_timeline();
    for (sim::BusSide& side : buses_) side.clear();
  }
  const std::int64_t period_ns = clock_.period_ns();
  clock_.set_arm_time_ns(std::clamp<std::int64_t>(number, 0, kLongest_ns / period_ns) * period_ns);
  apply_timeline();
  for (std::int64_t i = 0; i < clock_.steps_per_period(); ++i) step();
  for (sim::BusSide& side : buses_) side.send_directly(lockstep::tock(number));
  return true;
}

void Simulator::advance_to(std::int64_t sim_time_ns) noexcept {
  while (clock_.next_ns() <= sim_time_ns) {
    if (clock_.arm_time_known()) apply_timeline();
    step();
  }
  deliver();
}

void Simulator::step() noexcept {
  nodes_.command(&arm_);
  carry_frames();
  arm_.step(clock_.step_s(), clock_.now_ns(), clock_.next_ns(), nodes_.all_enabled());
  if (arm_.load_changed()) load_nodes();
  clock_.advance();
  nodes_.update(arm_, clock_.step_s(), clock_.now_ns(), &buses_);
}

// Frames that arrive during this step meet the arm as it is at its start.
void Simulator::carry_frames() noexcept {
  const std::int64_t offset_ns = clock_.arm_time_ns() - clock_.now_ns();
  CanFrame frame;
  std::int64_t at_ns = 0;
  for (int bus = 0; bus < static_cast<int>(buses_.size()); ++bus) {
    while (buses_[bus].carry(clock_.next_ns(), offset_ns, &frame, &at_ns))
      nodes_.receive(bus, frame, at_ns, &buses_[bus]);
  }
}

// --- the world -----------------------------------------------------------------------------------

void Simulator::set_timeline(const std::vector<TimedMessage>* timeline) noexcept {
  has_timeline_ = timeline != nullptr;
  timeline_ = Timeline(timeline);
}

void Simulator::restart_timeline() noexcept {
  timeline_.rewind();
  if (!has_timeline_) return;
  arm_.environment() = sim::Environment();
  arm_.reset_objects();
  set_payload(0.0, Eigen::Vector3d::Zero());
  nodes_.clear_faults();
}

void Simulator::apply_timeline() noexcept {
  while (const ScenarioMessage* message = timeline_.due(clock_.arm_time_ns())) {
    if (!apply(*message)) ++refused_;
  }
}

bool Simulator::apply(const ScenarioMessage& message) noexcept {
  if (const auto* a_push = std::get_if<push_t>(&message)) return push(*a_push);
  if (const auto* an_event = std::get_if<scenario_event_t>(&message)) return event(*an_event);
  return true;
}

bool Simulator::push(const push_t& message) noexcept {
  sim::Push push;
  return sim::read_push(message, arm_.body().model(), &push) &&
         arm_.environment().pushes.add(push, clock_.now_ns());
}

bool Simulator::event(const scenario_event_t& message) noexcept {
  sim::Payload payload;
  sim::NodeFault fault;
  switch (message.kind) {
    case scenario_event_t::EVENT_WALL:
      return sim::read_wall(message, &arm_.environment().wall);
    case scenario_event_t::EVENT_PAYLOAD:
      if (!sim::read_payload(message, &payload)) return false;
      set_payload(payload.mass, payload.p_TL);
      return true;
    case scenario_event_t::EVENT_FAULT:
      if (!sim::read_fault(message,
                           {nodes_.joints(), nodes_.has_tip_sensor(), nodes_.has_emergency_stop()},
                           &fault))
        return false;
      nodes_.inject(fault, clock_.now_ns());
      return true;
    default:
      return false;
  }
}

bool Simulator::workpiece(const workpiece_t& message) noexcept {
  return sim::read_workpiece(message, arm_.body().model().gravity, &arm_.environment().workpiece);
}

void Simulator::set_payload(double mass, const Eigen::Vector3d& p_TL) noexcept {
  arm_.set_payload(mass, p_TL);
  load_nodes();
}

void Simulator::load_nodes() noexcept {
  const sim::HeldMass load = arm_.tip_load();
  nodes_.set_payload(arm_, load.mass_kg, load.p_T);
}

const sim_truth_t& Simulator::truth() noexcept {
  truth_.seq = clock_.periods();
  truth_.sim_time_ns = clock_.now_ns();
  truth_.time_ns = clock_.arm_time_known() ? clock_.arm_time_ns() : 0;
  arm_.fill(truth_.sim_time_ns, &truth_);
  return truth_;
}

const block_truth_t* Simulator::block_truth() noexcept {
  const sim::Block* block = arm_.environment().workpiece.block();
  if (block == nullptr) return nullptr;
  block_truth_.seq = clock_.periods();
  block_truth_.time_ns = clock_.arm_time_known() ? clock_.arm_time_ns() : 0;
  block->fill(&block_truth_);
  return &block_truth_;
}

const hand_truth_t* Simulator::hand_truth() noexcept {
  if (arm_.hand() == nullptr) return nullptr;
  hand_truth_.seq = clock_.periods();
  hand_truth_.time_ns = clock_.arm_time_known() ? clock_.arm_time_ns() : 0;
  arm_.hand()->fill(&hand_truth_);
  return &hand_truth_;
}

}  // namespace limber
