// The arm floats: no spring, no damping but the joints' own.
//   tau = g
#include "controller/laws/law.h"

namespace limber::controller {
namespace {

class GravityCompensation : public Law {
 public:
  void compute(const LawInputs& /*inputs*/, LawOutput* /*output*/) noexcept override {}
};

}  // namespace

LawEntry gravity_compensation_law() {
  return {.name = "gravity_compensation",
          .summary = "floats: carries its weight and nothing else",
          .needs = sensors::kMotorEncoder,
          .goal_type = GoalType::kNone,
          .compensation = {.gravity = true},
          .potential = Potential::kGravity,
          .make = [](const LawArm&) -> std::unique_ptr<Law> {
            return std::make_unique<GravityCompensation>();
          }};
}

}  // namespace limber::controller
