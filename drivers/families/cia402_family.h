// CANopen drives with profile CiA 402 in cyclic synchronous torque mode. At the SYNC a drive
// executes its command (RPDO1) and sends its state (TPDO1, and those that follow it).
#pragma once

#include <atomic>

#include "drivers/families/cia402_startup.h"
#include "drivers/families/cia402_state.h"
#include "drivers/families/drive_family.h"
#include "drivers/protocols/cia402_pdos.h"

namespace limber {

class Cia402Family final : public DriveFamily {
 public:
  Cia402Family(const JointConfig& joint, bool fd, double period_s);

  /// The drive has no gains: tau = kp (angle - angle seen) + kd (speed - speed seen) + torque is
  /// computed here, a cycle late, and is `torque` alone if the drive was not seen of late. The
  /// rounding error of the torque, up to half a thousandth of the rated one, is added to the next.
  bool command(const DriveCommand& command, const DriveMemory& memory, CanFrame* frame,
               DriveCommand* sent) noexcept override;
  CanFrame disable() noexcept override { return without_torque(cia402::kDisableVoltage); }
  CanFrame clear_error() noexcept override {
    emergency_.store(0, std::memory_order_relaxed);  // not every drive takes it back
    return without_torque(cia402::kFaultReset);
  }
  /// Through ready to switch on and switched on, one state a confirmed step.
  CanFrame enable(const DriveMemory& memory) noexcept override;
  CanFrame state_request() const noexcept override { return canopen::encode_sync(); }
  CanFrame presence_request() const noexcept override;
  bool needs_bus_frame(CanFrame* bus_frame) const noexcept override {
    *bus_frame = canopen::encode_sync();
    return true;
  }

  /// TPDOs, SDO answers, emergencies, boot-up and heartbeat of the node.
  bool is_mine(const CanFrame& frame) const noexcept override;
  /// All of them but the TPDOs that make the state.
  bool is_unsolicited(const CanFrame& frame) const noexcept override;
  /// Keeps the code of an emergency until the drive takes it back.
  void note_unsolicited(const CanFrame& frame) noexcept override;
  std::uint16_t emergency() const noexcept override {
    return emergency_.load(std::memory_order_relaxed);
  }
  /// RPDOs, SDO requests that write, network management and SYNC.
  bool is_foreign_command(const CanFrame& frame) const noexcept override;
  std::vector<CanFilter> receive_filters() const override;
  bool is_presence(const CanFrame& frame) const noexcept override;
  void begin_cycle() noexcept override {
    last_state_ = state_;
    state_.begin();
  }
  StateReading read_state(const CanFrame& frame, bool late, DriveReport* report) noexcept override;
  std::string status_text(std::uint16_t status) const override;
  double angle_resolution() const noexcept override { return rad_per_count_; }

  bool disable_is_answered() const noexcept override { return false; }
  int patience_cycles() const noexcept override { return startup_.patience_cycles(); }
  int startup_steps() const noexcept override { return startup_.startup_steps(); }
  StartupStep startup_step(int index) const noexcept override {
    return startup_.startup_step(index);
  }
  CanFrame startup_request(int index) const noexcept override {
    return startup_.startup_request(index);
  }
  bool may_be_read_again(int index) const noexcept override {
    return startup_.may_be_read_again(index);
  }
  Answer check_answer(int index, const CanFrame& frame, double* found) noexcept override;
  std::string describe(const StartupFailure& failure) const override {
    return startup_.describe(failure);
  }

 private:
  std::uint8_t node() const noexcept { return canopen::node_of(drive_.command_id); }
  CanFrame without_torque(std::uint16_t controlword) noexcept;

  DriveConfig drive_;
  bool fd_;
  bool link_encoder_;
  bool torque_sensor_;
  double rad_per_count_;
  double link_rad_per_count_;
  double rated_current_A_;
  double most_torque_;      ///< N m: whole thousandths within the joint's limit
  double carry_ = 0.0;      ///< rounding error not sent yet, N m
  Cia402State state_;       ///< of this cycle
  Cia402State last_state_;  ///< of the one before: the rest of it may come late
  Cia402Startup startup_;
  std::atomic<std::uint16_t> emergency_ = 0;  ///< read by the thread that logs
};

}  // namespace limber
