// JOINT_STATE published -> JOINT_TORQUE received, through the real controller process, beside a
// bare UDP unicast ping-pong of the same sizes between two processes, in alternating batches of the
// same run. LIMBER_ARM_URL chooses the arm plane. Prints one JSON line; the figure that travels
// between machines is the ratio.
//
//   limber-bench-loop --controller build/release/bin/limber-controller [--rounds 20000]
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <limber/controller_status_t.hpp>
#include <limber/joint_command_t.hpp>
#include <limber/joint_state_t.hpp>
#include <limber/mode_request_t.hpp>
#include <stdexcept>

#include "common/arm_plane/arm_plane.h"
#include "common/clock.h"
#include "common/latency_histogram.h"
#include "common/lcm_port.h"
#include "common/program.h"
#include "common/realtime.h"
#include "lcmtypes/channels.h"
#include "qa/bench/udp_ping.h"
#include "robots/loader/load_robot.h"

using namespace limber;

namespace {

/// Plays the driver for one controller: answers every request at once, the arm never moves.
class FakeDriver {
 public:
  explicit FakeDriver(const LoadedRobot& robot)
      : arm_(arm_plane_url(), ArmPlaneEnd::kDriver), user_(user_plane_url()) {
    state_.session = 1;
    state_.period_ns = 1'000'000;
    state_.num_joints = static_cast<std::int8_t>(robot.robot.size());
    state_.drive_state = joint_state_t::DRIVE_OFF;
    for (int i = 0; i < robot.robot.size(); ++i) {
      state_.q[i] = state_.theta[i] = robot.robot.joints[static_cast<std::size_t>(i)].home;
      state_.joint_flags[i] = +joint_state_t::JOINT_FRESH | +joint_state_t::JOINT_ENABLED;
    }
    arm_.subscribe<joint_command_t>(channels::kJointTorque, [this](const joint_command_t& torque) {
      if (torque.state_seq == state_.seq) answer_ = torque, answered_ = true;
    });
    user_.subscribe<controller_status_t>(channels::kControllerStatus, 10,
                                         [this](const controller_status_t& status) {
                                           mode_ = status.mode;
                                           controller_ = status.controller;
                                         });
  }

  /// One cycle; returns the round trip in ns, or -1 if no answer came within a second.
  std::int64_t round() {
    answered_ = false;
    bench::pause_between_rounds();
    const std::int64_t start = monotonic_ns();
    arm_.publish(channels::kJointState, state_);
    while (!answered_ && arm_.wait(start + 1'000'000'000)) arm_.handle_waiting();
    const std::int64_t taken = monotonic_ns() - start;
    if (!answered_) return -1;
    ++state_.seq;
    state_.time_ns += state_.period_ns;
    if (answer_.request == joint_command_t::REQUEST_ON)
      state_.drive_state = joint_state_t::DRIVE_ON;
    std::copy(answer_.tau, answer_.tau + 16, state_.tau_applied);
    return taken;
  }

  void activate() {
    for (int i = 0; i < 20'000 && mode_ != controller_status_t::MODE_ACTIVE; ++i) {
      round();
      user_.handle_waiting();
      if (i % 200 == 199) {
        mode_request_t request{};
        request.controller = controller_;
        request.client = 1;
        request.seq = i;
        request.request = mode_ < controller_status_t::MODE_HOLD ? mode_request_t::REQUEST_HOLD
                                                                 : mode_request_t::REQUEST_ACTIVE;
        user_.publish(channels::kModeRequest, request);
      }
    }
    if (mode_ != controller_status_t::MODE_ACTIVE)
      throw std::runtime_error("the controller did not become ACTIVE");
  }

  const joint_state_t& state() const { return state_; }

 private:
  ArmPlane arm_;
  LcmPort user_;
  joint_state_t state_{};
  joint_command_t answer_{};
  bool answered_ = false;
  int mode_ = -1;
  std::int64_t controller_ = 0;
};

int run(const std::string& controller, std::int64_t rounds) {
  const LoadedRobot robot = load_robot("openarm");
  const pid_t child = spawn([&] {
    execl(controller.c_str(), controller.c_str(), "--robot", "openarm",
          static_cast<char*>(nullptr));
  });
  const std::size_t state_bytes = static_cast<std::size_t>(joint_state_t().getEncodedSize());
  const std::size_t torque_bytes = static_cast<std::size_t>(joint_command_t().getEncodedSize());
  bench::UdpPing udp(state_bytes, torque_bytes, true);
  const RealtimeGrant grant = ask_for_realtime(bench::kPriority);

  FakeDriver driver(robot);
  while (driver.round() < 0) {
  }
  driver.activate();
  LatencyHistogram limber_time;
  LatencyHistogram udp_time;
  constexpr int kBatch = 200;
  for (std::int64_t done = 0; done < rounds; done += kBatch) {
    for (int i = 0; i < kBatch; ++i) limber_time.add(driver.round());
    for (int i = 0; i < kBatch; ++i) udp_time.add(udp.round());
  }
  kill(child, SIGTERM);  // it closes its black box
  waitpid(child, nullptr, 0);
  const auto us = [](std::int64_t ns) { return static_cast<double>(ns) * 1e-3; };
  fmt::print(
      "{{\"arm_plane\": \"{}\", \"rounds\": {}, \"fifo\": {}, \"state_bytes\": {}, "
      "\"torque_bytes\": {},\n"
      " \"limber_us\": {{\"p50\": {:.1f}, \"p99\": {:.1f}, \"p999\": {:.1f}}},\n"
      " \"udp_us\": {{\"p50\": {:.1f}, \"p99\": {:.1f}, \"p999\": {:.1f}}},\n"
      " \"ratio_p50\": {:.3f}, \"ratio_p99\": {:.3f}}}\n",
      arm_plane_url(), rounds, grant.fifo, state_bytes, torque_bytes, us(limber_time.quantile(0.5)),
      us(limber_time.quantile(0.99)), us(limber_time.quantile(0.999)), us(udp_time.quantile(0.5)),
      us(udp_time.quantile(0.99)), us(udp_time.quantile(0.999)),
      static_cast<double>(limber_time.quantile(0.5)) / static_cast<double>(udp_time.quantile(0.5)),
      static_cast<double>(limber_time.quantile(0.99)) /
          static_cast<double>(udp_time.quantile(0.99)));
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine line("limber-bench-loop",
                   "Round trip JOINT_STATE -> JOINT_TORQUE beside a bare UDP unicast ping-pong.");
  std::string controller;
  std::int64_t rounds = 20'000;
  line.text("--controller", &controller, "limber-controller to measure").required();
  line.integer("--rounds", &rounds, 200, 10'000'000, "messages of each kind");
  return run_program(line, argc, argv, [&] { return run(controller, rounds); });
}
