#include "sim/plant/simulated_arm.h"

#include "sim/plant/start_state.h"

namespace limber::sim {

SimulatedArm::SimulatedArm(const LoadedRobot& plant, const Robot& robot, Integrator integrator,
                           bool friction, const VectorJ& q, bool stand,
                           const std::vector<ObjectConfig>& objects)
    : plant_(make_arm_plant(integrator, build_arm_model(plant))),
      forces_(plant.robot, robot, friction),
      stand_(stand) {
  if (plant.robot.hand) {
    const double believed = robot.hand.value().drive.drive.torque_constant_Nm_per_A;
    hand_.emplace(*plant.robot.hand, believed, friction, objects, plant.robot.gravity);
  }
  start_at(plant.robot, q, stand, plant_.get());
  if (stand) set_stands(plant.robot, plant_->state(), &forces_);
}

void SimulatedArm::step(double h, std::int64_t now_ns, std::int64_t next_ns, bool held) noexcept {
  if (stand_) {
    const double left = fade_.left(now_ns, held);
    forces_.set_stands_left(left);
    stand_ = left > 0.0;
  }
  forces_.environment.pushes.drop_finished(now_ns);
  // Pushes change slowly against a step: their value in its middle stands for all of it.
  plant_->step(&forces_, h, now_ns + (next_ns - now_ns) / 2);
  Workpiece& workpiece = forces_.environment.workpiece;
  if (workpiece.block() != nullptr) workpiece.advance(tip_motion(plant_->arm()), h);
  if (!hand_) return;
  const double carried_kg = hand_->held().mass_kg;
  hand_->step(hand_law, plant_->arm(), h);
  load_changed_ = hand_->held().mass_kg != carried_kg;
  if (load_changed_) load_tip();
}

HeldMass SimulatedArm::tip_load() const noexcept {
  const HeldMass held = hand_ ? hand_->held() : HeldMass();
  if (!(held.mass_kg > 0.0)) return payload_;
  const double mass_kg = payload_.mass_kg + held.mass_kg;
  return {mass_kg, (payload_.mass_kg * payload_.p_T + held.mass_kg * held.p_T) / mass_kg};
}

void SimulatedArm::load_tip() noexcept {
  const HeldMass load = tip_load();
  plant_->set_payload(load.mass_kg, load.p_T);
}

void SimulatedArm::reset_objects() noexcept {
  if (hand_) hand_->reset_objects();
}

}  // namespace limber::sim
