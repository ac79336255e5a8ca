// When a run of the driver ends by itself.
#pragma once

#include <cstdint>

namespace limber {

struct RunLength {
  std::int64_t cycles = 0;  ///< 0: for ever
  double duration_s = 0.0;  ///< arm time; 0: for ever

  bool reached(std::int64_t cycles_run, double arm_time_s) const noexcept {
    return (cycles > 0 && cycles_run >= cycles) ||
           (duration_s > 0.0 && arm_time_s >= duration_s - 1e-9);
  }
};

}  // namespace limber
