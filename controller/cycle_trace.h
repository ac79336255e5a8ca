// What happened in one control cycle. CONTROLLER_STATUS is written from it alone.
#pragma once

#include <array>
#include <cstdint>

#include "controller/laws/law.h"

namespace limber::controller {

struct CycleTrace {
  /// Forgets what a law did in the last cycle.
  void begin() noexcept {
    law.reset();
    reports.fill(0.0F);
    limits = 0;
  }

  // Of the cycle's owners, as they are.
  const ControlPoint& point;
  const ArmTerms& terms;
  const Goal& goal;
  const Gains& gains;           ///< effective, in base axes
  const LawSettings& settings;  ///< as chosen, also while HOLD does not use them
  const Estimates& estimates;

  // Of this cycle: the torque by its terms, N m, n each.
  LawOutput law;
  VectorJ tau_null;
  VectorJ tau_gravity;
  VectorJ tau_coriolis;
  VectorJ tau_friction;
  VectorJ tau_sent;

  int selected_law = 0;                ///< index in the registry
  std::array<float, 24> reports = {};  ///< of the running law, see LawEntry::reports
  std::int32_t limits = 0;             ///< controller_status_t LIMIT_* bits
  double tank_energy_J = 0.0;
  double passivity_energy_J = 0.0;
};

}  // namespace limber::controller
