#include "controller/impedance/damping_check.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "controller/impedance/elastic_design.h"

namespace limber::controller {

double overshoot(double ratio) noexcept {
  if (!(ratio < 1.0)) return 0.0;
  return std::exp(-std::numbers::pi * ratio / std::sqrt(1.0 - ratio * ratio));
}

const char* DampingCheck::check(const Gains& gains, const LawEntry& law, const ArmTerms& terms,
                                const JointElasticity& elastic) noexcept {
  if (law.damped == DampedAt::kNothing) return nullptr;
  const bool tip = law.damped == DampedAt::kTip;
  const DampingDesign chosen = tip ? gains.settings.damping : gains.settings.joint_damping;
  if (!reckons_with(&elastic, chosen)) return nullptr;
  const double asked = tip ? gains.damping_ratio : gains.joint_damping_ratio;
  const ElasticDesign design =
      tip ? tip_design(elastic, terms, gains) : joint_design(elastic, terms, gains);
  const double possible = design.least_ratio();
  if (!(overshoot(possible) > overshoot(asked) + kTold)) return nullptr;
  *fmt::format_to_n(text_.data(), text_.size() - 1,
                    FMT_STRING("{} is {:.3g}, {:.0f} % of overshoot; against the joints' springs "
                               "{:.2g} is possible in this pose, {:.0f} %"),
                    tip ? "damping_ratio" : "joint_damping_ratio", asked, 100.0 * overshoot(asked),
                    possible, 100.0 * overshoot(possible))
       .out = '\0';
  return text_.data();
}

}  // namespace limber::controller
