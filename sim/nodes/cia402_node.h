// An emulated CANopen drive (CiA 402) in cyclic synchronous torque mode, with a joint torque loop
// in its firmware if its joint has a torque sensor.
//
// A SYNC is answered with the TPDO's values of that instant; the command that waited for it takes
// effect after. The node speaks the drive's own angle (sign and offset of the robot's description);
// its link encoder counts as the joint does.
#pragma once

#include <cstdint>

#include "robots/loader/robot.h"
#include "sim/nodes/canopen_dictionary.h"
#include "sim/nodes/canopen_node.h"
#include "sim/nodes/cia402_machine.h"
#include "sim/nodes/joint_torque_loop.h"
#include "sim/nodes/motor_node.h"

namespace limber::sim {

/// Commanded torque u = (6071h + 60B2h) thousandths of the rated torque, within 6072h; zero when
/// operation becomes enabled. In a quick stop the phases are shorted; in a fault, too, if 605Eh
/// selects it and the fault is not in the power stage itself. Lost connections act while enabled,
/// as 6007h selects. After construction every member is allowed in the cycle.
class Cia402Node final : public MotorNode, private CanopenApplication {
 public:
  static constexpr std::int64_t kModeDelay_ns = 2'000'000;

  /// The mode is in force (6061h) that long after it is wanted (6060h).
  explicit Cia402Node(const JointConfig& joint, bool fd,
                      std::int64_t mode_delay_ns = kModeDelay_ns);
  Cia402Node(const Cia402Node&) = delete;
  Cia402Node& operator=(const Cia402Node&) = delete;

  bool receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
               CanFrame* reply) noexcept override;
  bool next_frame(CanFrame* frame) noexcept override;
  void update(const JointReading& joint, std::int64_t now_ns) noexcept override;
  /// Of the torque loop, where the joint has a torque sensor.
  double loop_rate_hz() const noexcept override;
  DriveLaw law() const noexcept override;
  bool enabled() const noexcept override;

  cia402::State state() const noexcept { return machine_.state(); }

 private:
  /// DRIVE_ERROR is an over-current (2310h); DROP_COMMANDS refuses to store what SDO writes.
  void on_fault(int fault, const JointReading& joint) noexcept override;
  /// Encoder readings: counts and counts/s.
  struct Sensed {
    double position, velocity, link_position, link_velocity;
  };

  void refresh() noexcept override;
  Refusal refuses(const DictionaryEntry& entry, double value) noexcept override;
  void on_written(canopen::ObjectId id) noexcept override;
  void on_connection_lost(std::uint16_t code) noexcept override;
  void on_reset() noexcept override;
  bool holds_errors() const noexcept override { return machine_.failed(); }

  Sensed sense() const noexcept;
  std::uint16_t statusword() const noexcept;
  void apply_controlword() noexcept;
  void apply_settings() noexcept;
  void apply_demand() noexcept;
  void fail(bool can_brake) noexcept;
  int option(const cia402::Object& object) noexcept;
  double motor_torque() const noexcept;

  JointConfig joint_;
  std::int64_t mode_delay_ns_;
  CanopenDictionary dictionary_;
  CanopenNode node_;
  Cia402Machine machine_;
  JointTorqueLoop loop_;
  double rated_torque_Nm_;
  double rated_current_A_;

  JointReading reading_;
  double demand_permille_ = 0.0;
  bool limited_ = false;
  bool braking_ = false;  ///< in a fault
  double mode_in_force_ = 0.0;
  std::int64_t mode_wanted_ns_ = 0;
  Sensed frozen_{};
};

}  // namespace limber::sim
