#include "drivers/protocols/odrive.h"

#include <algorithm>
#include <array>
#include <bit>
#include <string_view>

namespace limber::odrive {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::array kLayouts = {
    Layout{Message::kVersion, true, "version",
           "b protocol ,b hw_line ,b hw_version ,b hw_variant ,b fw_major ,b fw_minor ,b "
           "fw_revision ,b fw_unreleased "},
    Layout{Message::kHeartbeat, true, "heartbeat", "i error ,b state ,b result ,b done "},
    Layout{Message::kEstop, false, "emergency stop", ""},
    Layout{Message::kError, true, "error", "i active_errors ,i disarm_reason "},
    Layout{Message::kWriteEndpoint, false, "endpoint request", "b write ,h endpoint "},
    Layout{Message::kEndpoint, true, "endpoint", "b reserved ,h endpoint ,b reserved1 ,i raw "},
    Layout{Message::kAddress, true, "address", "b node "},
    Layout{Message::kSetState, false, "set state", "i state "},
    Layout{Message::kEstimates, true, "estimates", "f position turn,f velocity turn/s"},
    Layout{Message::kSetMode, false, "set mode", "i control_mode ,i input_mode "},
    Layout{Message::kTorque, false, "torque", "f torque N m"},
    Layout{Message::kSetLimits, false, "set limits", "f velocity turn/s,f current A"},
    Layout{Message::kIq, true, "currents", "f target A,f measured A"},
    Layout{Message::kTemperature, true, "temperature", "f FET degC,f motor degC"},
    Layout{Message::kReboot, false, "reboot", "b action "},
    Layout{Message::kSupply, true, "supply", "f voltage V,f current A"},
    Layout{Message::kClearErrors, false, "clear errors", ""},
    Layout{Message::kSetPosition, false, "set position", "f position turn"},
    Layout{Message::kTorques, true, "torques", "f target N m,f estimate N m"},
    Layout{Message::kPowers, true, "powers", "f electrical W,f mechanical W"},
};
constexpr std::string_view kErrors =
    "initialising|system|timing|missing estimate|bad configuration|gate driver|missing input||"
    "over-voltage|under-voltage|over-current|too much regeneration|current limit|motor too hot|"
    "inverter too hot|velocity limit|position limit||||||||watchdog expired|emergency stop|spinout|"
    "brake resistor|thermistor||calibration|";
constexpr std::string_view kStates =
    "undefined|idle|start-up|full calibration|motor calibration||index search|offset calibration|"
    "closed loop|lock-in|direction search|homing|";

/// The word with this number; empty: none.
std::string word(std::string_view words, std::uint32_t number) {
  while (number-- > 0 && !words.empty()) words.remove_prefix(words.find('|') + 1);
  return std::string(words.substr(0, words.find('|')));
}

}  // namespace

const Layout* layout_of(std::uint32_t id) noexcept {
  const auto message = static_cast<Message>(id & 0x1FU);
  const auto* const found = std::ranges::find(kLayouts, message, &Layout::message);
  return found == kLayouts.end() ? nullptr : found;
}

bool is_message(const CanFrame& frame, std::uint32_t node, Message message, int bytes) noexcept {
  return has_id(frame, id_of(node, message)) && !frame.remote && !frame.fd && frame.length >= bytes;
}

CanFrame ask(std::uint32_t node, Message message) noexcept {
  CanFrame frame = encode(node, message);
  frame.remote = true;
  return frame;
}

CanFrame read_endpoint(std::uint32_t node, std::uint16_t endpoint) noexcept {
  return encode(node, Message::kWriteEndpoint, std::uint8_t{0}, endpoint, std::uint8_t{0}, 0U);
}

bool decode_endpoint(const CanFrame& frame, std::uint32_t node, std::uint16_t endpoint, int bytes,
                     bool real, double* value) noexcept {
  if (!is_message(frame, node, Message::kEndpoint, 4 + bytes) ||
      field<std::uint16_t>(frame, 1) != endpoint)
    return false;
  *value = real         ? field<float>(frame, 4)
           : bytes == 4 ? field<std::uint32_t>(frame, 4)
                        : frame.data[4];
  return true;
}

std::string error_text(std::uint32_t errors) {
  if (errors == 0) return "";
  const auto bit = static_cast<std::uint32_t>(std::countr_zero(errors));
  const std::string text = word(kErrors, bit);
  return text.empty() ? "error bit " + std::to_string(bit) : text;
}

std::string state_text(std::uint32_t state) {
  const std::string text = word(kStates, state);
  return text.empty() ? "state " + std::to_string(state) : text;
}

}  // namespace limber::odrive
