// CANopen drives with profile CiA 402 in cyclic synchronous torque mode. A drive takes its command
// (RPDO1) and tells its state (TPDO1) at the SYNC, which is also what asks for the state.
#pragma once

#include "drivers/families/cia402_startup.h"
#include "drivers/families/drive_family.h"
#include "drivers/protocols/cia402.h"

namespace limber {

class Cia402Family final : public DriveFamily {
 public:
  Cia402Family(const JointConfig& joint, bool fd, double period_s);

  /// The drive knows no gains: tau = kp (angle - angle seen) + kd (speed - speed seen) + torque is
  /// computed here, a cycle late, and is `torque` alone if the drive was not seen of late. The
  /// rounding error of the torque, up to half a thousandth of the rated one, is added to the next.
  bool command(const DriveCommand& command, const DriveMemory& memory, CanFrame* frame,
               DriveCommand* sent) noexcept override;
  CanFrame disable() noexcept override { return without_torque(cia402::kDisableVoltage); }
  CanFrame clear_error() noexcept override { return without_torque(cia402::kFaultReset); }
  /// Through ready to switch on and switched on, one state a confirmed step.
  CanFrame enable(const DriveMemory& memory) noexcept override;
  CanFrame state_request() const noexcept override { return canopen::encode_sync(); }
  CanFrame presence_request() const noexcept override;
  bool needs_bus_frame(CanFrame* bus_frame) const noexcept override {
    *bus_frame = canopen::encode_sync();
    return true;
  }

  /// TPDO1, SDO answers, emergencies, boot-up and heartbeat of the node.
  bool is_mine(const CanFrame& frame) const noexcept override;
  /// All of them but TPDO1.
  bool is_aside(const CanFrame& frame) const noexcept override;
  bool read_state(const CanFrame& frame, DriveReport* report) const noexcept override;
  double angle_resolution() const noexcept override { return rad_per_count_; }

  bool disable_is_answered() const noexcept override { return false; }
  int patience_cycles() const noexcept override { return startup_.patience_cycles(); }
  int questions() const noexcept override { return startup_.questions(); }
  StartupQuestion question(int index) const noexcept override { return startup_.question(index); }
  CanFrame ask(int index) const noexcept override { return startup_.ask(index); }
  Answer judge(int index, const CanFrame& frame, double* found) const noexcept override {
    return startup_.judge(index, frame, found);
  }
  std::string describe(const StartupFailure& failure) const override {
    return startup_.describe(failure);
  }

 private:
  std::uint8_t node() const noexcept { return canopen::node_of(drive_.command_id); }
  CanFrame without_torque(std::uint16_t controlword) noexcept;

  DriveConfig drive_;
  bool fd_;
  bool link_encoder_;
  double rad_per_count_;
  double link_rad_per_count_;
  double rated_current_A_;
  double most_torque_;  ///< N m: whole thousandths within the joint's limit
  double carry_ = 0.0;  ///< rounding error not sent yet, N m
  Cia402Startup startup_;
};

}  // namespace limber
