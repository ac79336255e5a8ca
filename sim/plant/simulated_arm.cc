#include "sim/plant/simulated_arm.h"

#include "sim/plant/start_state.h"

namespace limber::sim {

SimulatedArm::SimulatedArm(const LoadedRobot& plant, const Robot& robot, Integrator integrator,
                           bool friction, const VectorJ& q, bool stand)
    : plant_(make_arm_plant(integrator, build_arm_model(plant))),
      forces_(plant.robot, robot, friction),
      stand_(stand) {
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
}

}  // namespace limber::sim
