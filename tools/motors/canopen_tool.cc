#include <fmt/format.h>

#include <stdexcept>

#include "drivers/protocols/canopen_sdo.h"
#include "tools/motors/motor_tool.h"

namespace limber::motor_tools {
namespace {

using canopen::ObjectId;
using canopen::SdoKind;
using canopen::SdoMessage;

constexpr int kCanopenLastNode = 127;
constexpr ObjectId kStatusword = {0x6041, 0};
constexpr std::uint32_t kStatusBits = 0x6F;
constexpr std::uint32_t kOperationEnabled = 0x27;

struct CanopenShown {
  ObjectId object;
  const char* name;
  const char* unit;
};
constexpr CanopenShown kCanopenShown[] = {
    {{0x1000, 0}, "device type", ""},      {{0x1018, 1}, "vendor", ""},
    {{0x1018, 2}, "product", ""},          {{0x1018, 3}, "revision", ""},
    {{0x6076, 0}, "rated torque", "mN m"}, {{0x6064, 0}, "position", "counts"},
    {{0x6079, 0}, "supply", "mV"},         {{0x603F, 0}, "error code", ""},
    {kStatusword, "statusword", ""},
};

std::uint8_t as_node(int number) { return static_cast<std::uint8_t>(number); }

class CanopenTool final : public MotorTool {
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

  std::vector<Value> show(Wire* wire, int number, bool /*fd*/) const override {
    std::vector<Value> values;
    for (const CanopenShown& shown : kCanopenShown) {
      const std::optional<std::uint32_t> value = read(wire, number, shown.object);
      const bool hexadecimal = *shown.unit == '\0';
      values.push_back({shown.name,
                        !value        ? "no such object"
                        : hexadecimal ? "0x" + bus_tools::hex(*value, 4)
                                      : std::to_string(static_cast<std::int32_t>(*value)),
                        value ? shown.unit : ""});
    }
    return values;
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
