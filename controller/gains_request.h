// Whether gains that somebody requests may be taken.
#pragma once

#include <limber/compliance_gains_t.hpp>

#include "controller/cycle_parts.h"
#include "controller/gains/gains_check.h"
#include "controller/impedance/damping_check.h"
#include "controller/impedance/stability.h"
#include "controller/kinds/refusal.h"
#include "controller/observers/estimator_check.h"

namespace limber::controller {

/// Merges a request with the last accepted one and checks the result: form and range, law, springs
/// of the joints, observers, stability. After construction all members may be called in the cycle.
class GainsRequest {
 public:
  struct Allowed {
    /// Demonstrations of mistakes, and goals out of reach: where every bus is simulated.
    bool demonstrations = false;
    bool unstable_gains = false;
  };
  /// `parts` outlive this and are changed by nothing here. The first accepted request is
  /// robot.yaml's.
  GainsRequest(const LoadedRobot& robot, CycleParts* parts, Allowed allowed);

  /// Nothing: accepted, perhaps with a warning, and gains() and law() are the new ones; else why
  /// not; then gains() are those of before, and law() is none.
  Refusal take(const compliance_gains_t& message) noexcept;

  const Gains& gains() const noexcept { return accepted_; }
  int law() const noexcept { return law_; }

 private:
  Refusal check(const compliance_gains_t& message, const compliance_gains_t& fields) noexcept;
  Refusal check_stability(const Gains& gains, const LawEntry& law) noexcept;

  CycleParts& parts_;
  GainsCheck gains_check_;
  StabilityCheck stability_;
  DampingCheck damping_;
  EstimatorCheck estimator_;
  bool unstable_allowed_;
  compliance_gains_t accepted_fields_;  // merged; no parameters
  Gains accepted_;                      // the same, with parameters
  Gains candidate_;
  int law_ = 0;
};

}  // namespace limber::controller
