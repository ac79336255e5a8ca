// Keeps the sampled law from putting energy into the arm at the tip.
#pragma once

#include "controller/kinds/goal.h"
#include "controller/kinds/law_entry.h"
#include "controller/observers/passivity_observer.h"

namespace limber::controller {

/// Passivity observer and controller (passivity_observer.h) on the translation of the tip: of the
/// energy that spring and damper exchange with it against the goal; what else the law exerts is
/// meant to do work. For laws that follow a pose. All members may be called in the cycle.
class PassivityGuard {
 public:
  void set_max_damping(double damping_Ns_per_m) noexcept {
    observer_.set_max_damping(damping_Ns_per_m);
  }
  void reset() noexcept {
    observer_.reset();
    F_pending_.setZero();
  }
  /// Counts the energy of the last cycle and adds the damping that takes a surplus back.
  void damp(const ArmTerms& terms, const Goal& goal, double period_s, GoalType type,
            LawOutput* law) noexcept {
    if (type != GoalType::kPose) {
      observer_.reset();
      return;
    }
    if (!observer_.started()) observer_.reset(law->spring_energy_J);
    observer_.observe(terms.X_BT.p - goal.X_BD.p);
    observer_.hold(F_pending_);
    const Eigen::Vector3d V = (terms.V_BT - goal.V_BD).head<3>();
    const Eigen::Vector3d F_added = -observer_.damping(V, period_s) * V;
    law->tau_damping += terms.J.topRows<3>().transpose() * F_added;
    law->F.head<3>() += F_added;
    F_pending_ = (law->F - law->F_other).head<3>();
  }
  double energy_J() const noexcept { return observer_.energy_J(); }

 private:
  PassivityObserver<Eigen::Vector3d> observer_{3, 0.0};
  Eigen::Vector3d F_pending_ = Eigen::Vector3d::Zero();  // computed now, acts from now on
};

}  // namespace limber::controller
