// What a control cycle costs: each law through the whole controller, the whole lab. Figures that
// travel are ratios within one run.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <string>

#include "controller/arm_controller.h"
#include "controller/laws/registry.h"
#include "controller/modes/state_judge.h"
#include "dynamics/levels.h"
#include "lab/lab.h"
#include "qa/bench/held_arm.h"
#include "robots/loader/default_gains.h"

namespace {

using namespace limber;

VectorJ home(const Robot& robot) {
  VectorJ q(robot.size());
  for (int i = 0; i < q.size(); ++i) q[i] = robot.joints[static_cast<std::size_t>(i)].home;
  return q;
}

/// A controller that has been led to ACTIVE by a driver that answers at once.
class ActiveController {
 public:
  ActiveController(const LoadedRobot& robot, const std::string& law)
      : controller_(robot, options()) {
    compliance_gains_t gains = default_gains(robot.robot);
    gains.client = 1;
    gains.law = law;
    // Nothing else runs without one.
    if (law == "admittance") gains.contact = compliance_gains_t::CONTACT_JOINT_TORQUE;
    controller_.on_gains(gains);
    state_.session = 1;
    state_.period_ns = 1'000'000;
    state_.num_joints = static_cast<std::int8_t>(robot.robot.size());
    state_.drive_state = joint_state_t::DRIVE_OFF;
    const VectorJ q = home(robot.robot);
    const controller::JointFlags equipment = controller::equipment_of(robot.robot);
    for (int i = 0; i < q.size(); ++i) {
      const JointConfig& joint = robot.robot.joints[static_cast<std::size_t>(i)];
      state_.q[i] = state_.theta[i] = q[i];
      state_.preload[i] = static_cast<float>(joint.transmission.preload_rad);
      state_.joint_flags[i] = +joint_state_t::JOINT_FRESH | +joint_state_t::JOINT_ENABLED |
                              equipment[static_cast<std::size_t>(i)];
    }
    ask_at(200, mode_request_t::REQUEST_HOLD);
    ask_at(1500, mode_request_t::REQUEST_ACTIVE);
    while (state_.seq < 3000) step();
  }

  bool active() const { return controller_.status().mode == controller_status_t::MODE_ACTIVE; }

  const joint_command_t& step() {
    const joint_command_t& torque = controller_.step(state_);
    if (torque.request == joint_command_t::REQUEST_ON) state_.drive_state = joint_state_t::DRIVE_ON;
    std::copy(torque.tau, torque.tau + kMaxJoints, state_.tau_applied);
    ++state_.seq;
    state_.time_ns += state_.period_ns;
    return torque;
  }

 private:
  static ArmControllerOptions options() {
    ArmControllerOptions options;
    options.simulated = true;
    options.measure_time = false;
    return options;
  }
  void ask_at(std::int64_t seq, std::int8_t what) {
    while (state_.seq < seq) step();
    mode_request_t request{};
    request.seq = seq;
    request.client = 1;
    request.request = what;
    controller_.on_mode(request);
  }

  ArmController controller_;
  joint_state_t state_{};
};

void BM_ControllerCycle(benchmark::State& run, const std::string& robot, const std::string& law) {
  LoadedRobot loaded = load_robot(robot);
  // tomei wants more than gravity's gradient.
  for (std::size_t i = 0; i < loaded.robot.joints.size(); ++i) {
    const double K_J = loaded.robot.joints[i].transmission.spring.stiffness_Nm_per_rad;
    if (K_J > 0.0) loaded.robot.gains.K_q[i] = 0.1 * K_J;
  }
  ActiveController controller(loaded, law);
  if (!controller.active()) run.SkipWithError("the controller did not become ACTIVE");
  for (auto _ : run) benchmark::DoNotOptimize(controller.step().tau[0]);
}

/// Driver, buses, nodes, arm at its default step, controller: one period of an arm that is held.
void BM_LabCycle(benchmark::State& run, const std::string& name, Integrator integrator) {
  const LoadedRobot robot = load_robot(name);
  Scenario scenario;
  scenario.integrator = integrator;
  mode_request_t hold{};
  hold.client = kScenarioClient;
  hold.request = mode_request_t::REQUEST_HOLD;
  scenario.timeline.push_back({300'000'000, hold});
  Lab lab(robot, scenario);
  while (lab.cycles() < 1500) lab.step();
  if (lab.state().drive_state != joint_state_t::DRIVE_ON) run.SkipWithError("the arm is not held");
  for (auto _ : run) lab.step();
  run.counters["x_real_time"] = benchmark::Counter(
      static_cast<double>(run.iterations()) / robot.robot.rate_hz, benchmark::Counter::kIsRate);
}

/// The same with all that can be left out left out: beside the two kernels in it.
void held_cycle(benchmark::State& run) {
  bench::HeldArm arm("openarm", Integrator::kReference);
  for (auto _ : run) arm.run(1);
}
BENCHMARK(held_cycle)->Name("lab_cycle/held");

/// Each law on the first of these arms that can run it: rigid, elastic, two motors a joint.
void register_controller_cycles() {
  const std::pair<const char*, const char*> kinds[] = {
      {"openarm", "rigid"}, {"iiwa14", "elastic"}, {"antagonist7", "antagonistic"}};
  for (const controller::LawEntry& law : controller::laws()) {
    for (const auto& [robot, kind] : kinds) {
      const unsigned sensors = controller::sensors_of(load_robot(robot).robot);
      if (controller::check_law(law, sensors) != nullptr) continue;
      const std::string name = fmt::format("BM_ControllerCycle/{}/{}", kind, law.name);
      benchmark::RegisterBenchmark(name.c_str(), BM_ControllerCycle, robot, law.name);
      break;
    }
  }
}

/// One arm of seven joints a kind; the ratio to the rigid one is what a kind of joint costs.
void register_lab_cycles() {
  const std::pair<const char*, const char*> kinds[] = {{"openarm", "rigid_mit"},
                                                       {"ideal7", "rigid"},
                                                       {"iiwa14", "flexible_torque_loop"},
                                                       {"baxter", "series_elastic"},
                                                       {"antagonist7", "antagonistic"}};
  for (const auto& [robot, kind] : kinds) {
    for (const Integrator integrator : {Integrator::kOde, Integrator::kReference}) {
      const std::string with = integrator == Integrator::kOde ? "ode" : "reference";
      benchmark::RegisterBenchmark(("BM_LabCycle/" + std::string(kind) + "/" + with).c_str(),
                                   BM_LabCycle, robot, integrator);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  register_controller_cycles();
  register_lab_cycles();
  std::string names;
  for (const dynamics::Level* level : dynamics::levels()) names += std::string(" ") + level->name;
  benchmark::AddCustomContext("levels", names);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
