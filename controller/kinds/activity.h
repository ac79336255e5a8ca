// What the cycle does in a mode.
#pragma once

#include <cstdint>

namespace limber::controller {

enum class Activity {
  kStandby,  ///< no law runs
  kHold,     ///< joint_pd where the arm was, with nothing of the user's choices but K_q: it carries
             ///< the weight and damps, whatever was tried before
  kLaw,      ///< the selected law
  kStop,     ///< the running law, while its goal comes to rest
};

/// How long a goal takes to come to rest in Activity::kStop.
inline constexpr std::int64_t kSoftStop_ns = 300'000'000;

}  // namespace limber::controller
