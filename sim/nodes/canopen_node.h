// The communication side of an emulated CANopen node (CiA 301): network management, heartbeats,
// SDO, SYNC and PDOs, emergencies. What the node is for, is its application's business.
#pragma once

#include <cstdint>
#include <string>

#include "drivers/can/can_frame.h"
#include "drivers/protocols/canopen.h"
#include "sim/nodes/canopen_dictionary.h"
#include "sim/nodes/canopen_errors.h"
#include "sim/nodes/canopen_pdo_records.h"
#include "sim/nodes/canopen_pdos.h"
#include "sim/nodes/canopen_sdo_server.h"
#include "sim/nodes/frame_queue.h"

namespace limber::sim {

/// As the guard it decides on the objects that are not CANopen's own.
class CanopenApplication : public DictionaryGuard {
 public:
  /// Puts what is measured into the dictionary, which is read next.
  virtual void refresh() noexcept = 0;
  /// Nobody commands any more: heartbeat or RPDO missing, or no longer operational. `code` is for
  /// an emergency message.
  virtual void on_connection_lost(std::uint16_t code) noexcept = 0;
  /// Node reset: the dictionary is as after power-on.
  virtual void on_reset() noexcept = 0;
  /// Errors stay until clear_errors(), even if their cause has gone.
  virtual bool holds_errors() const noexcept = 0;
};

/// After construction every member is allowed in the cycle.
class CanopenNode final : public DictionaryGuard {
 public:
  /// Adds CANopen's own objects to the dictionary, which the application has filled with its own,
  /// and closes it. Both outlive the node. `name`: manufacturer device name.
  CanopenNode(CanopenDictionary* dictionary, CanopenApplication* application, std::uint8_t node,
              bool fd, const std::string& name);

  /// With `deaf` the node handles SYNC and SDO reads only. True if `reply` is to be sent; more may
  /// wait in next_frame().
  bool receive(const CanFrame& frame, std::int64_t now_ns, bool deaf, CanFrame* reply) noexcept;
  void update(std::int64_t now_ns) noexcept;
  bool next_frame(CanFrame* frame) noexcept { return outbox_.pop(frame); }

  void raise(std::uint16_t code, std::uint8_t register_bit) noexcept;
  void clear(std::uint16_t code) noexcept;
  void clear_errors() noexcept;
  /// Of the latest error that is still there; 0: none.
  std::uint16_t error_code() const noexcept { return errors_.latest(); }

  canopen::NmtState state() const noexcept { return state_; }

  Refusal refuses(const DictionaryEntry& entry, double value) noexcept override;
  void on_written(canopen::ObjectId id) noexcept override;

 private:
  void add_objects(const std::string& name);
  void on_nmt(canopen::NmtCommand command) noexcept;
  void enter(canopen::NmtState state) noexcept;
  /// Power-on values for all objects up to that index.
  void boot(std::uint16_t last_reset) noexcept;
  bool on_sync(const CanFrame& frame, bool deaf, CanFrame* reply) noexcept;
  void on_rpdo(const CanFrame& frame) noexcept;
  void watch_heartbeat(const CanFrame& frame) noexcept;
  void watch_heartbeat() noexcept;
  void send_heartbeat() noexcept;
  void send_events() noexcept;
  void send_emergency(const canopen::Emergency& message) noexcept;
  bool operational() const noexcept { return state_ == canopen::NmtState::kOperational; }

  CanopenDictionary* dictionary_;
  CanopenApplication* application_;
  std::uint8_t node_;
  CanopenErrors errors_;
  CanopenPdoRecords records_;
  CanopenPdos pdos_;
  CanopenSdoServer sdo_;
  FrameQueue outbox_;
  canopen::NmtState state_ = canopen::NmtState::kBootUp;
  bool deaf_ = false;
  std::int64_t now_ns_ = 0;
  std::int64_t told_ns_ = 0;  ///< own heartbeat
  bool watching_ = false;     ///< a master's heartbeat has been heard
  std::int64_t heard_ns_ = 0;
};

}  // namespace limber::sim
