// Bytes of TARGET_STREAM and TORQUE_OVERLAY -> what the controller makes of them: torques that are
// finite, within their limits and without a jump, a goal that is finite and no faster than a stream
// may be, and counts that add up.
#include <array>
#include <cmath>

#include "tests/fuzz/support/active_controller.h"
#include "tests/fuzz/support/arms.h"
#include "tests/fuzz/support/patched_message.h"
#include "tests/fuzz/support/require.h"

using namespace limber;

namespace {

constexpr double kPeriod_s = 1e-3;
constexpr double kFastest_m_per_s = 1.0;  // of a stream, along each axis
constexpr double kInertia_kgm2 = 0.05, kFriction_Nms_per_rad = 1.0;

class Controller {
 public:
  explicit Controller(const LoadedRobot& arm)
      : arm_(arm.robot), controller_(arm, {}), state_(fuzz::state_at_home(arm_)) {
    fuzz::activate(&controller_, [this] { step(); });
    free_ = true;
    begin_messages();
  }

  void run(fuzz::FuzzInput input) {
    while (!input.empty()) {
      const auto kind = input.take<std::uint8_t>();
      for (int cycles = kind / 8; cycles > 0; --cycles) step();
      stream_.kind = static_cast<std::int8_t>(kind % 4);
      begin_messages();
      if (kind % 8 < 6) {
        const auto stream = fuzz::patched(stream_, input);
        if (!stream) continue;
        ++sent_;
        controller_.on_stream(*stream);
      } else if (const auto overlay = fuzz::patched(overlay_, input)) {
        controller_.on_overlay(*overlay);
      }
    }
    for (int i = 0; i < 200; ++i) step();
    const controller_status_t& status = controller_.status();
    fuzz::require(status.stream_taken + status.stream_stale + status.stream_refused == sent_,
                  "each message is taken, stale or refused");
    require_active();
    fuzz::require(status.stream_late <= status.stream_taken, "what is late is taken");
  }

 private:
  void require_active() const {
    const controller_status_t& status = controller_.status();
    fuzz::require(status.mode == controller_status_t::MODE_ACTIVE ||
                      status.reason == controller_status_t::REASON_CLIENT_SILENT,
                  "a law runs until targets have been out for as long as they allow");
  }

  /// Good ones for this moment: the input changes them.
  void begin_messages() {
    const controller_status_t& status = controller_.status();
    stream_.client = overlay_.client = fuzz::kClient;
    stream_.num_joints = overlay_.num_joints = state_.num_joints;
    stream_.t0_ns = state_.time_ns;
    stream_.delay_s = 0.05F;
    stream_.num_knots = 3;
    overlay_.valid_for_s = 0.01F;
    for (int k = 0; k < 16; ++k) {
      stream_.dt_s[k] = 0.03F * static_cast<float>(k);
      for (int i = 0; i < arm_.size(); ++i) stream_.value[k][i] = static_cast<float>(state_.q[i]);
      if (stream_.kind == target_stream_t::KIND_TWIST) std::fill_n(stream_.value[k], 6, 0.1F);
      if (stream_.kind != target_stream_t::KIND_POSE) continue;
      for (int i = 0; i < 3; ++i) stream_.value[k][i] = static_cast<float>(status.p_BD[i]);
      for (int i = 0; i < 4; ++i) stream_.value[k][3 + i] = static_cast<float>(status.quat_BD[i]);
    }
  }

  void step() {
    ++state_.seq;
    state_.time_ns += state_.period_ns;
    const joint_command_t& answer = controller_.step(state_);
    state_.drive_state = fuzz::drives_after(answer);
    for (int i = 0; i < arm_.size(); ++i) {
      const JointConfig& joint = arm_.joints[static_cast<std::size_t>(i)];
      const double tau = answer.tau[i];
      fuzz::require(std::isfinite(tau) && std::abs(tau) <= joint.torque_limit_Nm * (1.0 + 1e-9),
                    "a torque is finite and within its limit");
      const double most = joint.torque_rate_limit_Nm_per_s * kPeriod_s;
      double& last = last_[static_cast<std::size_t>(i)];
      fuzz::require(!free_ || std::abs(tau - last) <= most * (1.0 + 1e-9), "no torque jumps");
      last = tau;
      if (!free_) continue;
      const double push = tau - answer.tau_gravity[i] - kFriction_Nms_per_rad * state_.v[i];
      state_.v[i] += kPeriod_s * push / kInertia_kgm2;
      state_.q[i] += kPeriod_s * state_.v[i];
      state_.theta[i] = state_.q[i];
      state_.theta_dot[i] = state_.v[i];
    }
    judge_goal(controller_.status());
  }

  void judge_goal(const controller_status_t& status) {
    const bool led = status.stream != controller_status_t::STREAM_NONE;
    for (std::size_t i = 0; i < 3; ++i) {
      fuzz::require_finite({status.p_BD[i]}, "a goal is finite");
      if (led && led_) {
        fuzz::require(std::abs(status.p_BD[i] - goal_[i]) <= kFastest_m_per_s * kPeriod_s + 1e-9,
                      "a goal is no faster than a stream may be");
      }
      goal_[i] = status.p_BD[i];
    }
    led_ = led;
  }

  const Robot& arm_;
  ArmController controller_;
  joint_state_t state_;
  target_stream_t stream_{};
  torque_overlay_t overlay_{};
  std::array<double, 16> last_{};
  std::array<double, 3> goal_{};
  std::int32_t sent_ = 0;
  bool free_ = false;
  bool led_ = false;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const LoadedRobot arm = fuzz::load("openarm");
  Controller(arm).run({data, size});
  return 0;
}
