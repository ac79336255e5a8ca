// How punctual the cycles of a realtime run are. In lock step there is no clock, and all stays 0.
#pragma once

#include <cstdint>
#include <limber/driver_status_t.hpp>

#include "common/latency_histogram.h"

namespace limber {

/// Allowed in the cycle.
struct CycleTiming {
  LatencyHistogram lateness;  ///< start of the cycle after its deadline, ns
  LatencyHistogram answers;   ///< from JOINT_STATE published to the controller's answer, ns
  std::int64_t late_cycles = 0;
  std::int64_t overrun_cycles = 0;

  void write_status(driver_status_t* status) const noexcept {
    status->late_cycles = late_cycles;
    status->overrun_cycles = overrun_cycles;
    status->lateness_p50_ns = lateness.quantile(0.5);
    status->lateness_p99_ns = lateness.quantile(0.99);
    status->lateness_p999_ns = lateness.quantile(0.999);
    status->lateness_max_ns = lateness.max();
    status->answer_p50_ns = answers.quantile(0.5);
    status->answer_p99_ns = answers.quantile(0.99);
    status->answer_max_ns = answers.max();
  }
};

}  // namespace limber
