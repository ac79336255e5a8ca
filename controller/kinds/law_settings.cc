#include "controller/kinds/law_settings.h"

#include "lcmtypes/gains_table.h"

namespace limber::controller {

LawSettings read_settings(const compliance_gains_t& fields) noexcept {
  LawSettings s;
  s.position_feedback = static_cast<PositionFeedback>(fields.position_feedback);
  s.orientation = static_cast<Orientation>(fields.orientation);
  s.frame = static_cast<GainFrame>(fields.frame);
  s.model_compensation = static_cast<ModelCompensation>(fields.model_compensation);
  s.damping = static_cast<DampingDesign>(fields.damping);
  s.joint_damping = static_cast<DampingDesign>(fields.joint_damping);
  s.stiffness_terms = static_cast<StiffnessTerms>(fields.stiffness_terms);
  s.projector = static_cast<Projector>(fields.projector);
  s.contact = static_cast<ContactSource>(fields.contact);
  s.velocity = static_cast<VelocitySource>(fields.velocity);
  s.friction_compensation = static_cast<FrictionCompensation>(fields.friction_compensation);
  s.friction_share = static_cast<double>(fields.friction_share);
  s.velocity_cutoff_rad_per_s = static_cast<double>(fields.velocity_cutoff_rad_per_s);
  s.velocity_acceleration_rad_per_s2 = static_cast<double>(fields.velocity_acceleration_rad_per_s2);
  s.acceleration_filter_s = fields.acceleration_filter_s;
  s.observer_gain_per_s = static_cast<double>(fields.observer_gain_per_s);
  s.friction_observer_gain_per_s = static_cast<double>(fields.friction_observer_gain_per_s);
  s.tank_J = static_cast<double>(fields.tank_J);
  s.passivity_damping_Ns_per_m = static_cast<double>(fields.passivity_damping_Ns_per_m);
  s.spring_force_N = static_cast<double>(fields.spring_force_N);
  s.spring_moment_Nm = static_cast<double>(fields.spring_moment_Nm);
  for (std::size_t i = 0; i < kTerms; ++i) s.period_cycles[i] = fields.period_cycles[i];
  return s;
}

const LawSettings& default_settings() noexcept {
  static const LawSettings settings = read_settings(standard_gains());
  return settings;
}

}  // namespace limber::controller
