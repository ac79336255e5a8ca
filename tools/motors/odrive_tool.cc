// ODrive axes; 63 is one that has no number yet. Angles are left out: the gear is not told.
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "drivers/protocols/odrive.h"
#include "robots/loader/protocols/odrive_endpoints.h"
#include "tools/motors/motor_tool.h"

namespace limber::motor_tools {
namespace {

using odrive::Message;

constexpr double kOdriveHeartbeat_s = 0.3;
constexpr double kOdriveSave_s = 1.0;
constexpr std::uint8_t kOdriveProtocol = 2;

class OdriveTool final : public MotorTool {
 public:
  std::string_view protocol() const noexcept override { return "odrive"; }
  int last_number() const noexcept override { return odrive::kEverybody; }

  CanFrame presence(int number, bool /*fd*/) const noexcept override {
    const auto node = static_cast<std::uint32_t>(number);
    return odrive::ask(node, node == odrive::kEverybody ? Message::kAddress : Message::kVersion);
  }
  std::optional<Found> found(const CanFrame& frame) const override {
    const std::uint32_t node = odrive::node_of(frame.id);
    if (odrive::is_message(frame, odrive::kEverybody, Message::kAddress, 8) &&
        frame.data[0] == odrive::kEverybody)
      return Found{odrive::kEverybody, "without a number"};
    if (node < 1 || node >= odrive::kEverybody || frame.data[0] != kOdriveProtocol ||
        frame.data[4] != 0 || !odrive::is_message(frame, node, Message::kVersion, 8))
      return std::nullopt;
    return Found{static_cast<int>(node), "firmware " + firmware(frame)};
  }
  /// Of other families: 7FFh, which asks Damiao drives, starts the update of every axis's firmware.
  bool obeys(int number, std::uint32_t id) const noexcept override {
    const std::uint32_t node = odrive::node_of(id);
    return node == static_cast<std::uint32_t>(number) || node == odrive::kEverybody;
  }
  bool sends_unasked(const CanFrame& frame) const noexcept override {
    const std::uint32_t node = odrive::node_of(frame.id);
    const auto usual = [&](std::size_t at) {
      const auto value = odrive::field<float>(frame, at);
      return value == 0.0F || (std::isnormal(value) && std::abs(value) < 1e6F) || std::isnan(value);
    };
    if (odrive::is_message(frame, node, Message::kHeartbeat, 7))
      return frame.data[4] <= 14 && frame.data[5] <= 16 && frame.data[6] <= 1;
    return odrive::is_message(frame, node, Message::kEstimates, 8) && usual(0) && usual(4);
  }

  Measured measure(Wire* wire, int number, bool /*fd*/) const override {
    const CanFrame beat = heartbeat(wire, number);
    const auto errors = odrive::field<std::uint32_t>(beat, 0);
    const CanFrame estimates = ask(wire, number, Message::kEstimates);
    return {.temperature_degC = odrive::field<float>(ask(wire, number, Message::kTemperature), 0),
            .supply_V = odrive::field<float>(ask(wire, number, Message::kSupply), 0),
            .state = fmt::format("{}{}{}, {:.5g} turns", odrive::state_text(beat.data[4]),
                                 errors == 0 ? "" : ", ", odrive::error_text(errors),
                                 odrive::field<float>(estimates, 0))};
  }
  std::vector<Setting> settings(Wire* wire, int number, bool /*fd*/) const override {
    const CanFrame version = ask(wire, number, Message::kVersion);
    std::vector<Setting> all = {
        {.name = "firmware", .value = firmware(version), .robot_key = "motors.*.firmware"},
        {.name = "serial number",
         .value = bus_tools::bytes(ask(wire, number, Message::kAddress)).substr(3, 17),
         .use = Setting::Use::kModel}};
    const auto endpoints = odrive_endpoints(version.data[5] == 6 ? version.data[6] : 0);
    for (std::size_t i = 0; i < endpoints.size() && endpoints[i] != 0; ++i) {
      const OdriveEndpointKind& kind = kOdriveEndpoints[i];
      double value = 0.0;
      const auto node = static_cast<std::uint32_t>(number);
      if (wire->ask(odrive::read_endpoint(node, endpoints[i]), [&](const CanFrame& frame) {
            return odrive::decode_endpoint(frame, node, endpoints[i], kind.bytes, kind.real,
                                           &value);
          }))
        all.push_back({.name = kind.name, .value = fmt::format("{:g}", value)});
    }
    return all;
  }
  std::string_view not_read() const noexcept override {
    return "its settings are kept by its maker's tool: odrivetool backup-config";
  }
  bool enabled(Wire* wire, int number, bool /*fd*/) const override {
    return heartbeat(wire, number).data[4] == odrive::kClosedLoop;
  }

  void set_number(Wire* wire, int number, int wanted, bool fd) const override {
    if (wanted > odrive::kLastNode) throw std::runtime_error("63 is no number of an axis");
    CanFrame address = ask(wire, number, Message::kAddress);
    address.id = odrive::id_of(odrive::kEverybody, Message::kAddress);
    address.data[0] = static_cast<std::uint8_t>(wanted);
    const auto ignore = [](const CanFrame&) {};
    wire->send(address, Wire::kAnswer_s, ignore);
    wire->send(
        odrive::encode(static_cast<std::uint32_t>(wanted), Message::kReboot, std::uint8_t{1}),
        kOdriveSave_s, ignore);
    require_number(wire, wanted, fd);
  }
  void set_zero(Wire* /*wire*/, int /*number*/, bool /*fd*/) const override {
    throw std::runtime_error(
        "a position that it is given lasts until its next start only: write its angle as "
        "offset_rad, or let its maker's tool set the offset of its encoder");
  }

 private:
  static std::string firmware(const CanFrame& version) {
    return fmt::format("{}.{}.{}", version.data[4], version.data[5], version.data[6]);
  }
  static CanFrame ask(Wire* wire, int number, Message message) {
    const auto node = static_cast<std::uint32_t>(number);
    const auto reply = wire->ask(odrive::ask(node, message), [&](const CanFrame& frame) {
      return odrive::is_message(frame, node, message, 8);
    });
    if (!reply) throw std::runtime_error("it does not answer");
    return *reply;
  }
  static CanFrame heartbeat(Wire* wire, int number) {
    const auto beat = wire->await(
        [&](const CanFrame& frame) {
          return odrive::is_message(frame, static_cast<std::uint32_t>(number), Message::kHeartbeat,
                                    7);
        },
        kOdriveHeartbeat_s);
    if (!beat) throw std::runtime_error("it sends no heartbeat");
    return *beat;
  }
};

const OdriveTool kOdrive;

}  // namespace

extern const MotorTool* const kOdriveTool;
const MotorTool* const kOdriveTool = &kOdrive;

}  // namespace limber::motor_tools
