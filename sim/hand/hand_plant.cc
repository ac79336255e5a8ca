#include "sim/hand/hand_plant.h"

#include <algorithm>

namespace limber::sim {

void HandPlant::step(const DriveLaw& law, const LinkDynamics& arm, double h) noexcept {
  Squeezed object;
  if (objects_.between() != Objects::kNone) {
    const ObjectConfig& config = objects_.config(static_cast<std::size_t>(objects_.between()));
    object = {config.width_m, config.stiffness_N_per_m, config.damping_Ns_per_m};
  }
  fingers_.step(law, object, h);
  objects_.step(arm, fingers_.width(), fingers_.force(), h);
}

void HandPlant::fill(hand_truth_t* truth) const noexcept {
  const MotorPoint at = fingers_.point();
  truth->width_m = fingers_.width();
  truth->speed_m_per_s = fingers_.speed();
  truth->force_N = fingers_.force();
  truth->motor_Nm = fingers_.motor().torque(at);
  truth->friction_Nm = fingers_.motor().friction_torque();
  truth->winding_degC = fingers_.motor().winding_degC();
  truth->between = static_cast<std::int8_t>(objects_.between());
  truth->held = static_cast<std::int8_t>(objects_.held());
  truth->num_objects = static_cast<std::int8_t>(objects_.count());
  for (std::size_t i = 0; i < objects_.count(); ++i) {
    truth->object_flags[i] =
        static_cast<std::int8_t>((objects_.rests(i) ? hand_truth_t::OBJECT_RESTS : 0) |
                                 (objects_.slips(i) ? hand_truth_t::OBJECT_SLIPS : 0));
    std::copy_n(objects_.position(i).data(), 3, truth->p_BO[i]);
  }
}

}  // namespace limber::sim
