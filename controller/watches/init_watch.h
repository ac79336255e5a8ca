// What keeps the controller in INIT although the drives answer.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limber/controller_status_t.hpp>
#include <limber/joint_state_t.hpp>
#include <optional>

#include "common/joints.h"

namespace limber {

/// Allowed in the cycle.
class InitWatch {
 public:
  static constexpr std::int64_t kPatience_ns = 2'000'000'000;  ///< arm time, and at low rates
  static constexpr std::int64_t kPatienceCycles = 200;  ///< twice what the supervisor requires

  struct Finding {
    int joint;     ///< the one that is late most often
    double share;  ///< of the cycles
    double waited_s;
  };

  /// Each state that was answered; what was found, once an INIT.
  std::optional<Finding> note(std::int8_t mode, const joint_state_t& state) noexcept {
    const bool waits =
        mode == controller_status_t::MODE_INIT && state.drive_state == joint_state_t::DRIVE_OFF;
    if (!waits) {
      *this = InitWatch();
      return {};
    }
    if (states_++ == 0) begun_ns_ = state.time_ns;
    const std::int64_t waited_ns = state.time_ns - begun_ns_;
    Finding worst{0, 0.0, 1e-9 * static_cast<double>(waited_ns)};
    int joint = 0;
    for (std::int64_t& late : late_) {
      if (joint == state.num_joints) break;
      late += (state.joint_flags[joint] & joint_state_t::JOINT_FRESH) == 0;
      const double share = static_cast<double>(late) / static_cast<double>(states_);
      if (share > worst.share) {
        worst.joint = joint;
        worst.share = share;
      }
      ++joint;
    }
    if (told_ || waited_ns < std::max(kPatience_ns, kPatienceCycles * state.period_ns)) return {};
    told_ = true;
    return worst;
  }

 private:
  std::int64_t states_ = 0;
  std::int64_t begun_ns_{};
  std::array<std::int64_t, kMaxJoints> late_{};
  bool told_ = false;
};

}  // namespace limber
