#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "drivers/protocols/canopen_sdo.h"
#include "drivers/protocols/cia402.h"
#include "tools/motors/registers.h"

namespace limber::motor_tools {
namespace {

using canopen::ObjectId;
using canopen::SdoKind;
using canopen::SdoMessage;

constexpr int kCanopenLastNode = 127;
constexpr ObjectId kStatusword = {0x6041, 0};
constexpr std::uint32_t kStatusBits = 0x6F;
constexpr std::uint32_t kOperationEnabled = 0x27;

using enum Setting::Use;

/// Of a register's number, index << 8 | sub.
ObjectId object_of(std::uint32_t number) {
  return {static_cast<std::uint16_t>(number >> 8U), static_cast<std::uint8_t>(number)};
}
constexpr canopen::Object kStoreParameters = {{0x1010, 1}, 4};
constexpr std::uint32_t kSave = 0x65766173;  // "save"
constexpr double kCanopenStore_s = 0.5;

std::uint8_t as_node(int number) { return static_cast<std::uint8_t>(number); }

class CanopenTool final : public RegisterTool {
 public:
  std::string_view protocol() const noexcept override { return "cia402"; }
  int last_number() const noexcept override { return kCanopenLastNode; }

  CanFrame presence(int number, bool /*fd*/) const noexcept override {
    return canopen::encode_sdo_read(canopen::kDeviceType.id, as_node(number));
  }
  std::optional<Found> found(const CanFrame& frame) const override {
    SdoMessage message;
    if (frame.extended || frame.id <= canopen::kSdoAnswerCode ||
        frame.id > canopen::kSdoAnswerCode + kCanopenLastNode)
      return std::nullopt;
    const int node = static_cast<int>(frame.id - canopen::kSdoAnswerCode);
    if (!canopen::decode_sdo_answer(frame, as_node(node), &message) ||
        message.object != canopen::kDeviceType.id || message.kind != SdoKind::kRead)
      return std::nullopt;
    return Found{node, fmt::format("device profile {}", message.value & 0xFFFFU)};
  }

  /// Heartbeats, and the start of a node.
  bool sends_unasked(const CanFrame& frame) const noexcept override {
    return !frame.extended && frame.id > canopen::kHeartbeatCode &&
           frame.id <= canopen::kHeartbeatCode + kCanopenLastNode;
  }

  /// Velocity in counts/s, as CiA 402 has it unless its factors are changed.
  Measured measure(Wire* wire, int number, bool /*fd*/) const override {
    const auto value = [&](const canopen::Object& object) {
      const auto raw = read(wire, number, object.id);
      return !raw                ? Measured::kUnknown
             : object.bytes == 2 ? static_cast<std::int16_t>(*raw)
                                 : static_cast<double>(static_cast<std::int32_t>(*raw));
    };
    const double rad_per_count = 2.0 * std::numbers::pi / counts_per_turn(wire, number);
    const auto status = static_cast<std::uint16_t>(value(cia402::kStatusword));
    const auto code =
        static_cast<std::uint16_t>(read(wire, number, cia402::kErrorCode.id).value_or(0));
    std::string state = cia402::name_of(cia402::state_of(status));
    if (code != 0) state += fmt::format(", {:04X} {}", code, canopen::emergency_text(code));
    return {.angle_rad = value(cia402::kPosition) * rad_per_count,
            .velocity_rad_per_s = value(cia402::kVelocity) * rad_per_count,
            .torque_Nm = value(cia402::kTorqueActual) * value(cia402::kRatedTorque_mNm) * 1e-6,
            .supply_V = value(cia402::kSupply_mV) * 1e-3,
            .state = state};
  }

  std::vector<Setting> settings(Wire* wire, int number, bool fd) const override {
    std::vector<Setting> settings = RegisterTool::settings(wire, number, fd);
    const auto rated_mNm = read(wire, number, cia402::kRatedTorque_mNm.id);
    const auto add = [&](const char* name, double value, const char* key) {
      settings.push_back({name, fmt::format("{}", value), kOther, Format::kText, key});
    };
    add("counts per turn of the joint", counts_per_turn(wire, number), "motors.*.counts_per_turn");
    if (rated_mNm) add("rated torque (N m)", *rated_mNm * 1e-3, "motors.*.rated_torque_Nm");
    return settings;
  }
  std::string_view not_read() const noexcept override {
    return "objects of its maker are not here, and 1000h to 1FFFh only in part";
  }

  bool store(Wire* wire, int number, bool /*fd*/) const override {
    const bool stores = send(wire, number, kStoreParameters, kSave).empty();
    if (stores)
      static_cast<void>(wire->await([](const CanFrame&) { return false; }, kCanopenStore_s));
    return stores;
  }

  bool enabled(Wire* wire, int number, bool /*fd*/) const override {
    const std::optional<std::uint32_t> status = read(wire, number, kStatusword);
    return status && (*status & kStatusBits) == kOperationEnabled;
  }

  void set_number(Wire* /*wire*/, int /*number*/, int /*wanted*/, bool /*fd*/) const override {
    throw std::runtime_error("each maker sets node numbers in a way of its own: use its tool");
  }
  void set_zero(Wire* /*wire*/, int /*number*/, bool /*fd*/) const override {
    throw std::runtime_error(
        "each maker sets the zero in a way of its own: use its tool, or offset_rad of robot.yaml");
  }

 private:
  const std::vector<StoredRegister>& stored() const override {
    static const std::vector<StoredRegister> kStored = {
        {0x100000, "1000h:00 device type", Format::kUint32, kModel},
        {0x101801, "1018h:01 vendor", Format::kUint32, kModel},
        {0x101802, "1018h:02 product", Format::kUint32, kModel},
        {0x101803, "1018h:03 revision", Format::kUint32, kOther},
        {0x101804, "1018h:04 serial number", Format::kUint32, kOther},
        {0x101700, "1017h:00 heartbeat period (ms)", Format::kUint16, kWritable},
        {0x600700, "6007h:00 connection lost option", Format::kInt16, kWritable},
        {0x605A00, "605Ah:00 quick stop option", Format::kInt16, kWritable},
        {0x605B00, "605Bh:00 shutdown option", Format::kInt16, kWritable},
        {0x605C00, "605Ch:00 disable option", Format::kInt16, kWritable},
        {0x605D00, "605Dh:00 halt option", Format::kInt16, kWritable},
        {0x605E00, "605Eh:00 fault reaction option", Format::kInt16, kWritable},
        {0x607200, "6072h:00 maximum torque (thousandths)", Format::kUint16, kWritable},
        {0x607500, "6075h:00 rated current (mA)", Format::kUint32, kOther},
        {0x650200, "6502h:00 supported modes (bits)", Format::kUint32, kOther},
    };
    return kStored;
  }
  std::optional<std::uint32_t> try_read(Wire* wire, int number, std::uint32_t reg,
                                        bool /*fd*/) const override {
    return read(wire, number, object_of(reg));
  }
  /// All writable objects have two bytes.
  void put(Wire* wire, int number, const StoredRegister& reg, std::uint32_t raw,
           bool /*fd*/) const override {
    const std::string wrong = send(wire, number, {object_of(reg.number), 2}, raw & 0xFFFFU);
    if (!wrong.empty()) throw std::runtime_error(fmt::format("{}: {}", reg.name, wrong));
  }

  static double counts_per_turn(Wire* wire, int number) {
    const auto value = [&](const canopen::Object& object, std::uint32_t otherwise) {
      return static_cast<double>(read(wire, number, object.id).value_or(otherwise));
    };
    return value(cia402::kEncoderCounts, 0) / value(cia402::kEncoderTurns, 1) *
           value(cia402::kGearMotorTurns, 1) / value(cia402::kGearJointTurns, 1);
  }

  /// Why the node refuses it; empty: it does not. Throws if it does not answer.
  static std::string send(Wire* wire, int number, const canopen::Object& object,
                          std::uint32_t raw) {
    SdoMessage message;
    const auto mine = [&](const CanFrame& frame) {
      return canopen::decode_sdo_answer(frame, as_node(number), &message) &&
             message.object == object.id &&
             (message.kind == SdoKind::kWrite || message.kind == SdoKind::kAbort);
    };
    if (!wire->ask(canopen::encode_sdo_write(object, raw, as_node(number)), mine))
      throw std::runtime_error(
          fmt::format("writing {:04X}:{:02X} is not answered", object.id.index, object.id.sub));
    if (message.kind == SdoKind::kWrite) return "";
    return canopen::text_of(static_cast<canopen::SdoAbort>(message.value));
  }

  /// Nothing: the node has no such object. Throws if it does not answer.
  static std::optional<std::uint32_t> read(Wire* wire, int number, ObjectId object) {
    SdoMessage message;
    const auto mine = [&](const CanFrame& frame) {
      return canopen::decode_sdo_answer(frame, as_node(number), &message) &&
             message.object == object &&
             (message.kind == SdoKind::kRead || message.kind == SdoKind::kAbort);
    };
    if (!wire->ask(canopen::encode_sdo_read(object, as_node(number)), mine))
      throw std::runtime_error(
          fmt::format("object {:04X}:{:02X} is not answered", object.index, object.sub));
    if (message.kind == SdoKind::kAbort) return std::nullopt;
    return message.value;
  }
};

const CanopenTool kCanopen;

}  // namespace

extern const MotorTool* const kCanopenTool;
const MotorTool* const kCanopenTool = &kCanopen;

}  // namespace limber::motor_tools
