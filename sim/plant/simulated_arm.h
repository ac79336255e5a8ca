// The arm with its motors and its hand, in a world with walls, objects, pushes and a bench.
#pragma once

#include <limber/sim_truth_t.hpp>
#include <memory>
#include <optional>

#include "robots/loader/load_robot.h"
#include "scenarios/loader/scenario.h"
#include "sim/hand/hand_plant.h"
#include "sim/joints/stand.h"
#include "sim/plant/arm_plant.h"
#include "sim/plant/force_model.h"
#include "sim/plant/truth.h"

namespace limber::sim {

/// After construction every member is free of allocation, locks, logs and exceptions.
class SimulatedArm {
 public:
  /// At rest at q. `plant` is the arm as it is, `robot` what its drives believe it to be. On the
  /// stand it is carried until the drives hold it. Without a hand nothing meets the objects. Throws
  /// ConfigError.
  SimulatedArm(const LoadedRobot& plant, const Robot& robot, Integrator integrator, bool friction,
               const VectorJ& q, bool stand, const std::vector<ObjectConfig>& objects = {});

  /// One integration step of h seconds from simulated time now to next, with the drives' laws in
  /// forces().drives and hand_law. `held`: every drive is enabled.
  void step(double h, std::int64_t now_ns, std::int64_t next_ns, bool held) noexcept;

  /// A point mass at the tip, kg, at p_TL in tip axes, m; 0 removes it.
  void set_payload(double mass, const Eigen::Vector3d& p_TL) noexcept {
    payload_ = {mass, p_TL};
    load_tip();
  }
  /// Payload and held object as one point mass, at their centre.
  HeldMass tip_load() const noexcept;
  /// The arm carries more or less of what the hand holds than before the last step().
  bool load_changed() const noexcept { return load_changed_; }

  DriveLaw hand_law;
  /// nullptr without one.
  const HandPlant* hand() const noexcept { return hand_ ? &*hand_ : nullptr; }
  void reset_objects() noexcept;
  /// All fields but seq and the two times.
  void fill(std::int64_t now_ns, sim_truth_t* truth) noexcept {
    fill_truth(forces_, now_ns, plant_.get(), truth);
  }

  const LinkDynamics& body() const noexcept { return plant_->arm(); }
  const ArmState& state() const noexcept { return plant_->state(); }
  ForceModel& forces() noexcept { return forces_; }
  const ForceModel& forces() const noexcept { return forces_; }
  Environment& environment() noexcept { return forces_.environment; }
  const Environment& environment() const noexcept { return forces_.environment; }
  std::int64_t diverged() const noexcept { return plant_->diverged(); }

 private:
  void load_tip() noexcept;

  std::unique_ptr<ArmPlant> plant_;
  ForceModel forces_;
  std::optional<HandPlant> hand_;
  HeldMass payload_;
  bool load_changed_ = false;
  bool stand_;
  StandFade fade_;
};

}  // namespace limber::sim
