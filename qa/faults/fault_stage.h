// An arm that moves under a law, in lock step on a wire with bit time, and one fault.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "drivers/families/drive_family.h"
#include "lab/frame_log.h"
#include "lab/lab.h"
#include "qa/faults/tampered_bus.h"

namespace limber::faults {

/// What the driver made of a fault. Cycles count from the fault; -1: did not happen.
struct Reaction {
  int cycles = -1;  ///< until the drives were no longer ON; if they never were, until DRIVE_FAULT
  int state = 0;    ///< then, joint_state_t::DRIVE_*
  int cause = 0;    ///< then, FAULT_*
  int joint = -1;
  std::string text;              ///< what lies behind the cause, in words
  int fault_cycles = -1;         ///< until DRIVE_FAULT
  std::int64_t lost = 0;         ///< replies, over all motors
  std::int64_t late = 0;         ///< likewise
  std::int64_t invalid = 0;      ///< likewise
  std::int64_t foreign = 0;      ///< frames
  std::int64_t refused = 0;      ///< commands of the controller
  int verdict = 0;               ///< by which most of them were, driver_status_t::VERDICT_*
  bool returned = false;         ///< the drives were ON again although nobody acknowledged
  double moved_on_rad = 0.0;     ///< farthest from where the fault began while the drives were ON
  double moved_rad = 0.0;        ///< likewise, in all the time
  double speed_rad_per_s = 0.0;  ///< greatest, of all joints
  std::int64_t fault_ns = 0;     ///< arm time of its begin
};

/// Whether the frame has the drive's identifier `id`, whatever data that carries.
bool has_kind(const CanFrame& frame, const DriveConfig& drive, std::uint32_t id) noexcept;

/// Set-up and members allocate; nothing here runs beside a real arm.
class FaultStage {
 public:
  /// The tip goes round in a circle of 2 cm. `simulated`: what the drives have stored, where that
  /// differs from robot; null: the same. Both outlive the stage. `first_cycle`: its number.
  FaultStage(const LoadedRobot& robot, const LoadedRobot* simulated, std::int64_t first_cycle = 0);

  /// The drive that has the fault is that of joint 0.
  const JointConfig& joint() const { return robot_.robot.joints[0]; }
  const BusConfig& bus_config() const;
  TamperedBus& bus() { return *tampered_[static_cast<std::size_t>(joint().drive.bus)]; }
  std::vector<TamperedBus*>& buses() { return tampered_; }
  Simulator& simulator() { return lab_->simulator(); }
  /// Whether the frame is a reply of that drive to a command.
  bool is_mine(const CanFrame& frame) const;
  /// Its family, for frames of others that speak to it.
  const DriveFamily& family() const { return family_; }
  /// What arrives in the place of the drive's replies; all other frames pass.
  void change_replies(TamperedBus::Change change);
  /// Somebody else sends a frame on the drive's bus, at the start of a cycle.
  void send_from_outside(const CanFrame& frame);
  /// What reaches the gate in the place of the controller's answers, from now on.
  using AnswerChange =
      std::function<void(const joint_command_t& answer, std::vector<joint_command_t>* instead)>;
  void change_answers(AnswerChange change) { answer_change_ = std::move(change); }
  const Robot& robot() const { return robot_.robot; }
  /// That the answers are to.
  const joint_state_t& state() const { return lab_->state(); }
  /// Writes all buses' frames to a candump log from now on. Throws ConfigError.
  void record(const std::string& path);
  /// For what is random in a fault.
  void seed(unsigned seed) { seed_ = seed; }
  unsigned seed() const { return seed_; }
  /// Before every cycle from now on.
  void set_each_cycle(std::function<void()> call) { each_cycle_ = std::move(call); }

  /// One more cycle.
  void step();
  /// Runs the first `cycles` cycles.
  void run(int cycles);
  /// The drives are ON and every request was accepted.
  bool moves() const;
  /// So many more cycles, from a fault that begins now.
  Reaction watch(int cycles);

 private:
  bool on() const;
  bool tells_setting(const CanFrame& frame) const;

  const LoadedRobot& robot_;
  Scenario scenario_;
  std::vector<TamperedBus*> tampered_;
  std::unique_ptr<Lab> lab_;
  std::vector<std::unique_ptr<CanBus>> outside_;
  DriveFamily family_;
  std::function<void()> each_cycle_;
  AnswerChange answer_change_;
  std::unique_ptr<FrameLog> frames_;
  unsigned seed_ = 1;
};

}  // namespace limber::faults
