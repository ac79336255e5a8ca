// limber-lab: runs a scenario in one process, in lock step, and leaves the same log the three
// processes leave.
#include <spdlog/spdlog.h>

#include <cstdio>
#include <memory>

#include "common/clock.h"
#include "common/program.h"
#include "controller/controller_log.h"
#include "controller/laws/registry.h"
#include "drivers/drives_text.h"
#include "lab/frame_log.h"
#include "lab/lab.h"
#include "lab/log_writer.h"
#include "lcmtypes/channels.h"

using namespace limber;

namespace {

// What the processes log, see ArmPort and ControllerProcess.
class Told {
 public:
  explicit Told(const Robot& robot) : joints_(robot.joint_names()), controller_(joints_) {}

  void note(Lab& lab) {
    const joint_state_t& state = lab.state();
    controller_.note(lab.controller_status(), state.fault);
    for (const RequestOutcome& outcome : lab.controller().timeline_outcomes())
      ControllerLog::note(answer_to(outcome, state.time_ns));
    if (state.fault == fault_) return;
    fault_ = state.fault;
    const auto joint = static_cast<std::size_t>(state.fault_joint);
    spdlog::info(drives_text(
        state.drive_state, fault_, joint < joints_.size() ? joints_[joint] : "",
        lab.driver().fault_text(fault_, state.fault_joint, lab.driver().fault_detail())));
  }

 private:
  std::vector<std::string> joints_;
  ControllerLog controller_;
  std::int8_t fault_ = joint_state_t::FAULT_NONE;
};

void log_cycle(Lab& lab, LogWriter& log) {
  const std::int64_t time_ns = lab.state().time_ns;
  const std::int64_t seq = lab.state().seq;
  log.write(time_ns, channels::kJointState, lab.state());
  log.write(time_ns, channels::kSimTruth, lab.truth());
  log.write(time_ns, channels::kJointTorque, lab.torque());
  for (const RequestOutcome& outcome : lab.controller().timeline_outcomes())
    log.write(time_ns, channels::kRequestAnswer, answer_to(outcome, time_ns));
  if (seq % channels::kControllerStatusEvery == 0) {
    log.write(time_ns, channels::kControllerStatus, lab.controller_status());
  }
  if (seq % channels::kRobotInfoEvery == 0)
    log.write(time_ns, channels::kRobotInfo, lab.controller().robot_info());
  if (seq % channels::kDriverStatusEvery == 0)
    log.write(time_ns, channels::kDriverStatus, lab.driver_status());
}

struct Arguments {
  std::string scenario;
  std::string log;
  std::string can;
  bool progress = false;
};

int run(const Arguments& given) {
  const std::string& path = given.scenario;
  const bool progress = given.progress;
  const LoadedRobot robot = load_robot(scenario_robot(path));
  const Scenario scenario = load_scenario(path, robot, &controller::law_catalog());
  Lab lab(robot, scenario);
  Told told(robot.robot);
  std::unique_ptr<LogWriter> log;
  if (!given.log.empty()) log = std::make_unique<LogWriter>(given.log);
  std::unique_ptr<FrameLog> frames;
  if (!given.can.empty()) frames = std::make_unique<FrameLog>(given.can, robot.robot, &lab);

  const auto end_ns = static_cast<std::int64_t>(scenario.duration_s * 1e9);
  const std::int64_t start_ns = monotonic_ns();
  std::int64_t told_ns = start_ns;
  while (lab.time_ns() < end_ns) {
    lab.step();
    told.note(lab);
    if (log) log_cycle(lab, *log);
    if (frames) frames->write_cycle(lab.state().time_ns);
    if (progress && lab.cycles() % 100 == 0 && monotonic_ns() - told_ns > 200'000'000) {
      told_ns = monotonic_ns();
      std::fprintf(stderr, "\r%6.2f of %.2f s", static_cast<double>(lab.time_ns()) * 1e-9,
                   scenario.duration_s);
    }
  }
  if (log) {
    log->write(lab.state().time_ns, channels::kDriverStatus, lab.driver_status());
    log->close();
  }
  if (frames) frames->flush();
  const double wall_s = static_cast<double>(monotonic_ns() - start_ns) * 1e-9;
  std::fprintf(stderr, "%s%.2f s of arm time in %.2f s: %.1f times real time\n",
               progress ? "\r" : "", scenario.duration_s, wall_s, scenario.duration_s / wall_s);
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine line(
      "limber-lab",
      "Runs a scenario in one process, in lock step, as fast as the processor allows.");
  Arguments given;
  line.text("scenario", &given.scenario, "scenario file").required();
  line.text("--log", &given.log, "LCM event log to write; compressed if it ends in .zst");
  line.text("--can", &given.can, "CAN frames to write, in candump's log format, in arm time");
  line.flag("--progress", &given.progress, "show how far it is");
  return run_program(line, argc, argv, [&] { return run(given); });
}
