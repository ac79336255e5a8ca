// A lab whose controller breaks one limit of its first joint, from 1.3 s on, and writes the frames.
// For the tests of the trace checker only.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>
#include <memory>

#include "common/config_error.h"
#include "common/program.h"
#include "driver_view.h"
#include "qa/faults/fault_stage.h"

using namespace limber;

namespace {

constexpr int kBegin = 1300;
constexpr int kCycles = 2500;

/// Torque of the first joint in a cycle, counted from the begin.
using Misdeed = std::function<double(int cycle, const joint_state_t&, const joint_command_t&)>;

/// Ever more torque, in steps that are allowed.
double ramp(const JointConfig& joint, double step, double most, int cycle, double before) {
  return std::min(before + 0.9 * step * (cycle + 1), most * joint.torque_limit_Nm);
}

std::map<std::string, Misdeed> misdeeds(const JointConfig& joint, double rate_hz) {
  const double step = joint.torque_rate_limit_Nm_per_s / rate_hz;
  const auto start = std::make_shared<double>(0.0);
  const auto last = std::make_shared<double>(0.0);
  return {
      {"torque",
       [=, &joint](int cycle, const joint_state_t&, const joint_command_t& answer) {
         if (cycle == 0) *start = answer.tau[0];
         return ramp(joint, step, 1.2, cycle, *start);
       }},
      {"rate",
       [=](int cycle, const joint_state_t&, const joint_command_t& answer) {
         return answer.tau[0] + (cycle % 2 == 0 ? 3.0 * step : 0.0);
       }},
      {"speed",
       [=, &joint](int cycle, const joint_state_t&, const joint_command_t& answer) {
         if (cycle == 0) *start = answer.tau[0];
         return ramp(joint, step, 0.95, cycle, *start);
       }},
      {"position",
       [=, &joint](int cycle, const joint_state_t& state, const joint_command_t& answer) {
         if (cycle == 0) {
           *start = state.q[0];
           *last = answer.tau[0];
         }
         const double goal = std::max(*start - 2e-3 * cycle, joint.position_min - 0.3);
         const double pull = 20.0 * (goal - state.q[0]) - 1.0 * state.v[0];
         const double wanted = answer.tau_gravity[0] + std::clamp(pull, -3.0, 3.0);
         *last += std::clamp(wanted - *last, -0.9 * step, 0.9 * step);
         return *last;
       }},
      {"finite", [](int, const joint_state_t&,
                    const joint_command_t&) { return std::numeric_limits<double>::quiet_NaN(); }},
  };
}

int run(const std::string& robot_name, const std::string& limit, const std::string& trace) {
  const LoadedRobot robot = load_robot(robot_name);
  const LoadedRobot view = misbehaving::driver_view(robot);
  const auto all = misdeeds(robot.robot.joints[0], robot.robot.rate_hz);
  if (!all.contains(limit)) throw ConfigError("no limit '" + limit + "'");
  faults::FaultStage stage(view, &robot);
  stage.record(trace);
  stage.run(kBegin);
  stage.change_answers([&, cycle = 0](const joint_command_t& answer, auto* instead) mutable {
    instead->push_back(answer);
    instead->back().tau[0] = all.at(limit)(cycle++, stage.state(), answer);
  });
  if (limit == "finite") misbehaving::send_what_is_no_number(&stage);
  stage.run(kBegin + kCycles);
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine line("misbehaving-lab", "Breaks one limit of an arm and writes its CAN frames.");
  std::string robot;
  std::string limit;
  std::string trace;
  line.text("robot", &robot, "name or folder").required();
  line.text("limit", &limit, "torque, rate, speed, position or finite").required();
  line.text("trace", &trace, "candump log to write").required();
  return run_program(line, argc, argv, [&] { return run(robot, limit, trace); });
}
