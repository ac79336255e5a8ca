// Bytes of JOINT_STATE and of requests -> what the controller makes of them: it always answers,
// with torques that are finite and within the joints' limits.
#include <cmath>

#include "robots/loader/default_gains.h"
#include "tests/fuzz/support/active_controller.h"
#include "tests/fuzz/support/arms.h"
#include "tests/fuzz/support/patched_message.h"
#include "tests/fuzz/support/require.h"

using namespace limber;

namespace {

class Controller {
 public:
  explicit Controller(const LoadedRobot& arm)
      : arm_(arm.robot),
        controller_(arm, {}),
        state_(fuzz::state_at_home(arm_)),
        gains_(default_gains(arm.robot)) {
    request_ = fuzz::activate(&controller_, [this] { step(state_); });
  }

  void run(fuzz::FuzzInput input) {
    while (!input.empty()) {
      const auto kind = input.take<std::uint8_t>();
      const auto cycles = kind / 8 % 8;
      for (int i = 0; i < cycles; ++i) step(state_);
      if (kind % 8 < 4) {
        if (const auto state = fuzz::patched(next_state(), input)) step(*state);
      } else if (kind % 8 == 4) {
        controller_.on_silence();
      } else if (kind % 8 == 5) {
        if (const auto request = fuzz::patched(request_, input)) controller_.on_mode(*request);
      } else if (kind % 8 == 6) {
        if (const auto goal = fuzz::patched(goal_, input)) controller_.on_goal(*goal);
      } else if (const auto gains = fuzz::patched(gains_, input)) {
        controller_.on_gains(*gains);
      }
    }
    for (int i = 0; i < 5; ++i) step(state_);
  }

 private:
  const joint_state_t& next_state() {
    ++state_.seq;
    state_.time_ns += state_.period_ns;
    return state_;
  }

  void step(const joint_state_t& state) {
    const joint_command_t& answer = controller_.step(&state == &state_ ? next_state() : state);
    state_.drive_state = fuzz::drives_after(answer);
    fuzz::require(answer.num_joints == arm_.size(), "an answer is for this arm");
    for (int i = 0; i < arm_.size(); ++i) {
      const double limit = arm_.joints[static_cast<std::size_t>(i)].torque_limit_Nm;
      for (const double tau : {answer.tau[i], answer.tau_gravity[i]})
        fuzz::require(std::isfinite(tau) && std::abs(tau) <= limit * (1.0 + 1e-9),
                      "a torque is finite and within its limit");
      fuzz::require_finite({answer.tau_preload[i]}, "a preload torque is finite");
    }
  }

  const Robot& arm_;
  ArmController controller_;
  joint_state_t state_;
  mode_request_t request_{};
  compliance_goal_t goal_{};
  compliance_gains_t gains_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const LoadedRobot arm = fuzz::load("planar2r");
  Controller(arm).run({data, size});
  return 0;
}
