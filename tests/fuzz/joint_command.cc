// Bytes of JOINT_TORQUE -> verdict of the driver, and what then leaves for the motors: read from
// the bytes on the bus, not from the driver.
#include <cmath>

#include "tests/drivers/fake_arm.h"
#include "tests/fuzz/support/patched_message.h"
#include "tests/fuzz/support/require.h"

using namespace limber;

namespace {

constexpr int kJoints = 2;
constexpr double kLimit_Nm = 8.0;
constexpr double kStep_Nm = 0.5;
constexpr double kCount_Nm = 20.0 / 4095.0;

class Arm {
 public:
  Arm() : arm_(testing::test_robot(kJoints)) { fuzz::require(arm_.switch_on(), "switched on"); }

  void run(fuzz::FuzzInput input) {
    while (!input.empty()) {
      const auto kind = input.take<std::uint8_t>();
      for (int i = 0; i < kJoints; ++i) {
        if (kind % 4 == 3) arm_.set_speed(i, input.small());
      }
      cycle();
      arm_.command.state_seq = arm_.state->seq;
      arm_.command.time_ns = arm_.state->time_ns;
      arm_.command.request = static_cast<std::int8_t>(kind / 4 % 5);
      const auto command = fuzz::patched(arm_.command, input);
      if (command && arm_.driver->accept(*command) == driver_status_t::VERDICT_ACCEPTED)
        std::copy_n(command->tau, kJoints, arm_.command.tau);
    }
    cycle();
  }

 private:
  void cycle() {
    for (testing::FakeMotor& motor : arm_.motors) motor.frames.clear();
    arm_.half_cycle();
    for (std::size_t i = 0; i < kJoints; ++i) {
      fuzz::require(arm_.motors[i].frames.size() == 1, "one frame to each motor");
      judge(i, arm_.motors[i].last());
      fuzz::require_finite({arm_.state->q[i], arm_.state->v[i], arm_.state->tau_applied[i]},
                           "a published state is finite");
    }
  }

  void judge(std::size_t joint, const CanFrame& frame) {
    if (frame.id == 0x7FF || testing::is_special(frame)) {
      last_[joint] = 0.0;
      return;
    }
    const auto raw = testing::raw_command(frame);
    const double tau = -10.0 + raw.t * kCount_Nm;
    fuzz::require(std::abs(tau) <= kLimit_Nm + 1e-9, "no torque over its limit leaves");
    // Where the torque is given up, it may fall to nothing at once.
    fuzz::require(std::abs(tau) <= kStep_Nm + 2.0 * kCount_Nm ||
                      std::abs(tau - last_[joint]) <= kStep_Nm + 2.0 * kCount_Nm,
                  "no step over its limit leaves");
    last_[joint] = tau;
  }

  testing::FakeArm arm_;
  std::array<double, kJoints> last_{};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Arm().run({data, size});
  return 0;
}
