#include "sim/nodes/canopen_node.h"

namespace limber::sim {
namespace {

using canopen::NmtCommand;
using canopen::NmtState;
using canopen::SdoAbort;

constexpr std::int64_t kNsPerMs = 1'000'000;
constexpr std::uint16_t kFirstCommunication = 0x1000;
constexpr std::uint16_t kLastCommunication = 0x1FFF;
constexpr std::uint16_t kLastIndex = 0xFFFF;
constexpr double kServoDrive = 0x0002'0192;  // device type: CiA 402, servo drive
constexpr double kVendor = 0x6C69'6D62;      // "limb": CiA has given limber no number
constexpr double kProduct = 402;
constexpr double kRevision = 0x0001'0000;
constexpr std::uint8_t kLastNode = 127;
constexpr double kStayOperational = 1.0;
constexpr double kStop = 2.0;

}  // namespace

CanopenNode::CanopenNode(CanopenDictionary* dictionary, CanopenApplication* application,
                         std::uint8_t node, bool fd, const std::string& name)
    : dictionary_(dictionary),
      application_(application),
      node_(node),
      errors_(dictionary),
      records_(dictionary, node, fd),
      pdos_(dictionary, fd),
      sdo_(dictionary, node) {
  add_objects(name);
  dictionary_->close(this);
  boot(kLastIndex);
}

void CanopenNode::add_objects(const std::string& name) {
  using enum ValueType;
  const auto read_only = [this](const canopen::Object& object, ValueType type, double value) {
    dictionary_->add(object, type, value, Access::kReadOnly, Mapping::kNo);
  };
  read_only(canopen::kDeviceType, kU32, kServoDrive);
  read_only(canopen::kSyncCobId, kU32, canopen::kSyncId);
  dictionary_->add_text({0x1008, 0}, name, Access::kReadOnly);
  dictionary_->add_text({0x1009, 0}, "simulated", Access::kReadOnly);  // hardware version
  dictionary_->add_text({0x100A, 0}, "limber 1", Access::kReadOnly);   // software version
  read_only({{0x1014, 0}, 4}, kU32, canopen::kEmergencyCode + node_);
  read_only({{canopen::kConsumerHeartbeat.id.index, 0}, 1}, kU8, 1);
  dictionary_->add_writable(canopen::kConsumerHeartbeat, kU32, 0, 0, 0x7FFFFF);
  dictionary_->add_writable(canopen::kHeartbeatPeriod_ms, kU16, 0, 0, 65535);
  read_only({{0x1018, 0}, 1}, kU8, 4);
  for (std::uint8_t entry = 0; const double value : {kVendor, kProduct, kRevision, 1.0 * node_})
    read_only({{0x1018, ++entry}, 4}, kU32, value);  // the last: serial number
  read_only({{0x1200, 0}, 1}, kU8, 2);               // SDO server
  read_only({{0x1200, 1}, 4}, kU32, canopen::kSdoRequestCode + node_);
  read_only({{0x1200, 2}, 4}, kU32, canopen::kSdoAnswerCode + node_);
  dictionary_->add_writable(canopen::kSyncCounterOverflow, kU8, 0, 0, 240);
  read_only({{canopen::kErrorBehaviour.id.index, 0}, 1}, kU8, 1);
  dictionary_->add_writable(canopen::kErrorBehaviour, kU8, 0, 0, kStop);
}

// --- network management --------------------------------------------------------------------------

void CanopenNode::boot(std::uint16_t last_reset) noexcept {
  dictionary_->reset(kFirstCommunication, last_reset);
  sdo_.reset();
  pdos_.load(&records_);
  pdos_.restart();
  watching_ = false;
  outbox_.push(canopen::encode_heartbeat(NmtState::kBootUp, node_));
  state_ = NmtState::kPreOperational;
}

void CanopenNode::on_nmt(NmtCommand command) noexcept {
  switch (command) {
    case NmtCommand::kStart:
      return enter(NmtState::kOperational);
    case NmtCommand::kStop:
      return enter(NmtState::kStopped);
    case NmtCommand::kPreOperational:
      return enter(NmtState::kPreOperational);
    case NmtCommand::kResetCommunication:
      enter(NmtState::kPreOperational);
      return boot(kLastCommunication);
    case NmtCommand::kResetNode:
      clear_errors();
      boot(kLastIndex);
      return application_->on_reset();
  }
}

void CanopenNode::enter(NmtState state) noexcept {
  const bool lost = operational() && state != NmtState::kOperational;
  if (state == NmtState::kOperational && !operational()) pdos_.restart();
  if (state == NmtState::kStopped) sdo_.reset();
  state_ = state;
  if (lost) application_->on_connection_lost(canopen::kCommunicationError);
}

// --- frames --------------------------------------------------------------------------------------

bool CanopenNode::receive(const CanFrame& frame, std::int64_t now_ns, bool deaf,
                          CanFrame* reply) noexcept {
  now_ns_ = now_ns;
  deaf_ = deaf;
  if (frame.error || frame.remote || frame.extended) return false;
  if (frame.id == canopen::kSyncId) return on_sync(frame, deaf, reply);
  if (frame.id == canopen::kSdoRequestCode + node_) {
    if (state_ == NmtState::kStopped) return false;
    application_->refresh();
    return sdo_.receive(frame, now_ns, reply);
  }
  if (deaf) return false;
  NmtCommand command;
  if (canopen::decode_nmt(frame, node_, &command)) on_nmt(command);
  watch_heartbeat(frame);
  if (operational()) on_rpdo(frame);
  return false;
}

bool CanopenNode::on_sync(const CanFrame& frame, bool deaf, CanFrame* reply) noexcept {
  const bool counted = dictionary_->value(canopen::kSyncCounterOverflow) > 1.0;
  if (frame.length != (counted ? 1 : 0)) {
    raise(canopen::kSyncLength, canopen::kErrorCommunication);
    return false;
  }
  clear(canopen::kSyncLength);
  if (!operational()) return false;
  application_->refresh();
  bool replied = false;
  for (int k = 0; k < CanopenPdos::kPdos; ++k) {
    CanFrame frame_due;
    if (!pdos_.due_at_sync(k, &frame_due)) continue;
    if (replied)
      outbox_.push(frame_due);
    else
      *reply = frame_due;
    replied = true;
  }
  if (!deaf) pdos_.apply();
  return replied;
}

void CanopenNode::on_rpdo(const CanFrame& frame) noexcept {
  switch (pdos_.receive(frame, now_ns_)) {
    case CanopenPdos::Heard::kTooShort:
      return raise(canopen::kPdoTooShort, canopen::kErrorCommunication);
    case CanopenPdos::Heard::kTaken:
      clear(canopen::kPdoTooShort);
      return clear(canopen::kRpdoTimeout);
    case CanopenPdos::Heard::kNothing:
      return;
  }
}

Refusal CanopenNode::refuses(const DictionaryEntry& entry, double value) noexcept {
  if (deaf_) return SdoAbort::kCannotStore;
  if (CanopenPdoRecords::is_record(entry.id.index))
    return records_.refuses(entry, value, state_ == NmtState::kPreOperational);
  return application_->refuses(entry, value);
}

void CanopenNode::on_written(canopen::ObjectId id) noexcept {
  if (id == canopen::kErrorCount.id) errors_.forget_history();
  if (id == canopen::kConsumerHeartbeat.id) watching_ = false;
  if (id == canopen::kHeartbeatPeriod_ms.id) told_ns_ = now_ns_;
  if (CanopenPdoRecords::is_record(id.index)) return pdos_.load(&records_);
  application_->on_written(id);
}

// --- time ----------------------------------------------------------------------------------------

void CanopenNode::update(std::int64_t now_ns) noexcept {
  now_ns_ = now_ns;
  CanFrame frame;
  if (sdo_.give_up(now_ns, &frame)) outbox_.push(frame);
  send_heartbeat();
  watch_heartbeat();
  if (!operational()) return;
  if (pdos_.timed_out(now_ns)) {
    raise(canopen::kRpdoTimeout, canopen::kErrorCommunication);
    application_->on_connection_lost(canopen::kRpdoTimeout);
  }
  send_events();
}

void CanopenNode::send_events() noexcept {
  CanFrame frame;
  for (int k = 0; k < CanopenPdos::kPdos; ++k) {
    if (!pdos_.awaits_event(k)) continue;
    application_->refresh();
    if (pdos_.due_on_event(k, now_ns_, &frame)) outbox_.push(frame);
  }
}

void CanopenNode::send_heartbeat() noexcept {
  const double period_ms = dictionary_->value(canopen::kHeartbeatPeriod_ms);
  if (period_ms == 0.0 || static_cast<double>(now_ns_ - told_ns_) < period_ms * kNsPerMs) return;
  told_ns_ = now_ns_;
  outbox_.push(canopen::encode_heartbeat(state_, node_));
}

void CanopenNode::watch_heartbeat(const CanFrame& frame) noexcept {
  if (frame.id < canopen::kHeartbeatCode) return;
  const auto watched = static_cast<std::uint32_t>(dictionary_->value(canopen::kConsumerHeartbeat));
  const auto master = static_cast<std::uint8_t>(watched >> 16U);
  NmtState state;
  if (master == 0 || master > kLastNode || (watched & 0xFFFFU) == 0 ||
      !canopen::decode_heartbeat(frame, master, &state))
    return;
  watching_ = true;
  heard_ns_ = now_ns_;
  clear(canopen::kHeartbeatLost);
}

void CanopenNode::watch_heartbeat() noexcept {
  const auto watched = static_cast<std::uint32_t>(dictionary_->value(canopen::kConsumerHeartbeat));
  if (!watching_ || now_ns_ - heard_ns_ <= static_cast<std::int64_t>(watched & 0xFFFFU) * kNsPerMs)
    return;
  watching_ = false;
  raise(canopen::kHeartbeatLost, canopen::kErrorCommunication);
  application_->on_connection_lost(canopen::kHeartbeatLost);
  const double behaviour = dictionary_->value(canopen::kErrorBehaviour);
  if (!operational() || behaviour == kStayOperational) return;
  state_ = behaviour == kStop ? NmtState::kStopped : NmtState::kPreOperational;
}

// --- errors --------------------------------------------------------------------------------------

void CanopenNode::send_emergency(const canopen::Emergency& message) noexcept {
  if (state_ != NmtState::kStopped) outbox_.push(canopen::encode_emergency(message, node_));
}

void CanopenNode::raise(std::uint16_t code, std::uint8_t register_bit) noexcept {
  canopen::Emergency message;
  if (errors_.raise(code, register_bit, &message)) send_emergency(message);
}

void CanopenNode::clear(std::uint16_t code) noexcept {
  canopen::Emergency message;
  if (!application_->holds_errors() && errors_.clear(code, &message)) send_emergency(message);
}

void CanopenNode::clear_errors() noexcept {
  canopen::Emergency message;
  if (errors_.clear_all(&message)) send_emergency(message);
}

}  // namespace limber::sim
