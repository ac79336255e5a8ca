// The part of controller_status_t that describes one cycle.
#pragma once

#include <limber/controller_status_t.hpp>

#include "controller/cycle_trace.h"

namespace limber::controller {

/// Writes what the trace holds; the rest of the status is left as it is. In the cycle.
void write_status(const CycleTrace& trace, controller_status_t* status) noexcept;

}  // namespace limber::controller
