// Whether springs in the joints let a tip or joints be damped as they are asked to be.
#pragma once

#include <array>

#include "controller/elastic/joint_elasticity.h"
#include "controller/kinds/gains.h"
#include "controller/kinds/law_entry.h"
#include "controller/model/arm_terms.h"

#pragma GCC visibility push(default)
namespace limber::controller {

class DampingCheck {
 public:
  /// What is told of, as overshoot more than the ratio asked has.
  static constexpr double kTold = 0.03;

  /// nullptr if this law's damper can give every mode about the ratio asked in this pose, else what
  /// is possible: of the mode that misses it most. The text lasts until the next call. In the
  /// cycle.
  const char* check(const Gains& gains, const LawEntry& law, const ArmTerms& terms,
                    const JointElasticity& elastic) noexcept;

 private:
  std::array<char, 160> text_{};
};

/// Of a mode with this damping ratio, as a share of where it comes from; 0 from 1 on.
double overshoot(double ratio) noexcept;

}  // namespace limber::controller
#pragma GCC visibility pop
