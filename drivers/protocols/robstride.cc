#include "drivers/protocols/robstride.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace limber::robstride {
namespace {

constexpr double kMiddle = 32767.0;
constexpr double kTopSymmetric = 65534.0;
constexpr double kTopGain = 65535.0;
constexpr double kTemperatureCount_degC = 0.1;

std::uint16_t quantise(double counts, double top, bool round) noexcept {
  if (!(counts > 0.0)) return 0;  // NaN, too
  if (!(counts < top)) return static_cast<std::uint16_t>(top);
  return static_cast<std::uint16_t>(round ? counts + 0.5 : counts);
}
std::uint16_t symmetric(double value, double range, bool round) noexcept {
  return quantise((value / range + 1.0) * kMiddle, kTopSymmetric, round);
}
double from_symmetric(std::uint16_t count, double range) noexcept {
  return (count - kMiddle) * range / kMiddle;
}

void put(CanFrame* frame, std::size_t at, std::uint16_t value) noexcept {
  frame->data[at] = static_cast<std::uint8_t>(value >> 8U);
  frame->data[at + 1] = static_cast<std::uint8_t>(value);
}
std::uint16_t get(const CanFrame& frame, std::size_t at) noexcept {
  return static_cast<std::uint16_t>(frame.data[at] << 8U | frame.data[at + 1]);
}
void put_little(CanFrame* frame, std::size_t at, std::uint32_t value) noexcept {
  for (unsigned i = 0; i < 4; ++i)
    frame->data[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
}
std::uint32_t get_little(const CanFrame& frame, std::size_t at) noexcept {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < 4; ++i)
    value |= static_cast<std::uint32_t>(frame.data[at + i]) << (8 * i);
  return value;
}

CanFrame frame_of(const Id& id) noexcept {
  CanFrame frame;
  frame.id = to_number(id);
  frame.extended = true;
  frame.length = 8;
  return frame;
}

CanFrame parameter_frame(const Id& id, std::uint16_t index, std::uint32_t raw) noexcept {
  CanFrame frame = frame_of(id);
  frame.data[0] = static_cast<std::uint8_t>(index);
  frame.data[1] = static_cast<std::uint8_t>(index >> 8U);
  put_little(&frame, 4, raw);
  return frame;
}
std::uint16_t index_of(const CanFrame& frame) noexcept {
  return static_cast<std::uint16_t>(frame.data[0] | frame.data[1] << 8U);
}

/// Data 1, 2, 3, ...: what the manual has where a frame must not come by chance.
CanFrame counting(Type type, std::uint8_t motor, std::uint8_t bytes) noexcept {
  CanFrame frame = frame_of({type, kHost, motor});
  for (std::uint8_t i = 0; i < bytes; ++i) frame.data[i] = static_cast<std::uint8_t>(i + 1);
  return frame;
}

}  // namespace

const char* fault_text(int bit) noexcept {
  constexpr std::array<const char*, kFaults> kTexts = {"under-voltage",     "over-current",
                                                       "over-temperature",  "encoder error",
                                                       "stall or overload", "not calibrated"};
  return kTexts[static_cast<std::size_t>(bit)];
}

std::string faults_text(std::uint8_t faults) {
  std::string text;
  for (int bit = 0; bit < kFaults; ++bit) {
    if ((faults >> static_cast<unsigned>(bit) & 1U) != 0)
      text += (text.empty() ? "" : ", ") + std::string(fault_text(bit));
  }
  return text;
}

const char* reported_fault_text(int bit) noexcept {
  switch (bit) {
    case 0:
      return "motor too hot";
    case 1:
      return "driver chip";
    case 2:
      return "under-voltage";
    case 3:
      return "over-voltage";
    case 4:
      return "over-current, phase B";
    case 5:
      return "over-current, phase C";
    case 7:
      return "encoder not calibrated";
    case 8:
      return "hardware identification";
    case 9:
      return "position at start";
    case 14:
      return "stall";
    case 16:
      return "over-current, phase A";
    default:
      return "";
  }
}

std::uint32_t to_number(const Id& id) noexcept {
  return static_cast<std::uint32_t>(id.type) << 24U | static_cast<std::uint32_t>(id.data) << 8U |
         id.target;
}

bool split(const CanFrame& frame, Id* id) noexcept {
  if (!frame.extended || frame.remote || frame.error || frame.fd || frame.length != 8) return false;
  *id = {static_cast<Type>(frame.id >> 24U), static_cast<std::uint16_t>(frame.id >> 8U),
         static_cast<std::uint8_t>(frame.id)};
  return true;
}

CanFrame request(Type type, std::uint8_t motor) noexcept { return frame_of({type, kHost, motor}); }

CanFrame encode_clear(std::uint8_t motor) noexcept {
  CanFrame frame = request(Type::kStop, motor);
  frame.data[0] = kClear;
  return frame;
}

CanFrame encode_set_zero(std::uint8_t motor) noexcept {
  CanFrame frame = request(Type::kSetZero, motor);
  frame.data[0] = 1;
  return frame;
}

CanFrame encode_set_id(std::uint8_t motor, std::uint8_t wanted) noexcept {
  return frame_of({Type::kSetId, static_cast<std::uint16_t>(wanted << 8U | kHost), motor});
}

CanFrame encode_save(std::uint8_t motor) noexcept { return counting(Type::kSave, motor, 8); }

CanFrame encode_set_baud(std::uint8_t motor, std::uint8_t code) noexcept {
  CanFrame frame = counting(Type::kSetBaud, motor, 6);
  frame.data[6] = code;
  return frame;
}

CanFrame encode_report(std::uint8_t motor, bool on) noexcept {
  CanFrame frame = counting(Type::kReport, motor, 6);
  frame.data[6] = on ? 1 : 0;
  return frame;
}

CanFrame encode_presence(std::uint8_t motor, std::uint64_t unique) noexcept {
  CanFrame frame = frame_of({Type::kPing, motor, kEverybody});
  put_little(&frame, 0, static_cast<std::uint32_t>(unique));
  put_little(&frame, 4, static_cast<std::uint32_t>(unique >> 32U));
  return frame;
}

bool encode_command(const Command& command, const CommandRange& range, std::uint8_t motor,
                    CanFrame* frame) noexcept {
  if (!mit::all_finite(command) || !mit::is_usable(range)) return false;
  *frame = frame_of({Type::kControl, symmetric(command.torque_Nm, range.torque_Nm, true), motor});
  put(frame, 0, symmetric(command.position_rad, range.position_rad, true));
  put(frame, 2, symmetric(command.velocity_rad_per_s, range.velocity_rad_per_s, true));
  put(frame, 4, quantise(command.kp_Nm_per_rad / range.kp_Nm_per_rad * kTopGain, kTopGain, true));
  put(frame, 6, quantise(command.kd_Nms_per_rad / range.kd_Nms_per_rad * kTopGain, kTopGain, true));
  return true;
}

bool decode_command(const CanFrame& frame, const CommandRange& range, Command* command) noexcept {
  Id id{};
  if (!split(frame, &id) || id.type != Type::kControl) return false;
  *command = {from_symmetric(get(frame, 0), range.position_rad),
              from_symmetric(get(frame, 2), range.velocity_rad_per_s),
              get(frame, 4) * range.kp_Nm_per_rad / kTopGain,
              get(frame, 6) * range.kd_Nms_per_rad / kTopGain,
              from_symmetric(id.data, range.torque_Nm)};
  return true;
}

CanFrame encode_state(const State& state, const CommandRange& range, Type type) noexcept {
  const auto flags = static_cast<std::uint32_t>(state.mode) << 6U | state.faults;
  CanFrame frame =
      frame_of({type, static_cast<std::uint16_t>(flags << 8U | state.motor), state.host});
  put(&frame, 0, symmetric(state.position_rad, range.position_rad, false));
  put(&frame, 2, symmetric(state.velocity_rad_per_s, range.velocity_rad_per_s, false));
  put(&frame, 4, symmetric(state.torque_Nm, range.torque_Nm, false));
  put(&frame, 6, quantise(state.temperature_degC / kTemperatureCount_degC, kTopGain, true));
  return frame;
}

bool decode_state(const CanFrame& frame, const CommandRange& range, State* state) noexcept {
  Id id{};
  if (!split(frame, &id) || (id.type != Type::kState && id.type != Type::kReport)) return false;
  state->motor = static_cast<std::uint8_t>(id.data);
  state->host = id.target;
  state->mode = static_cast<Mode>(id.data >> 14U);
  state->faults = id.data >> 8U & 0x3FU;
  state->position_rad = from_symmetric(get(frame, 0), range.position_rad);
  state->velocity_rad_per_s = from_symmetric(get(frame, 2), range.velocity_rad_per_s);
  state->torque_Nm = from_symmetric(get(frame, 4), range.torque_Nm);
  state->temperature_degC = get(frame, 6) * kTemperatureCount_degC;
  return true;
}

double torque_count_Nm(const CommandRange& range) noexcept { return range.torque_Nm / kMiddle; }

CanFrame encode_read(std::uint8_t motor, std::uint16_t index) noexcept {
  return parameter_frame({Type::kRead, kHost, motor}, index, 0);
}

CanFrame encode_write(std::uint8_t motor, std::uint16_t index, std::uint32_t raw) noexcept {
  return parameter_frame({Type::kWrite, kHost, motor}, index, raw);
}

bool decode_parameter_request(const CanFrame& frame, ParameterRequest* request) noexcept {
  Id id{};
  if (!split(frame, &id) || (id.type != Type::kRead && id.type != Type::kWrite)) return false;
  *request = {id.type == Type::kWrite, index_of(frame), get_little(frame, 4)};
  return true;
}

CanFrame encode_parameter_answer(const ParameterAnswer& answer) noexcept {
  const auto data = static_cast<std::uint16_t>((answer.refused ? 1U : 0U) << 8U | answer.motor);
  return parameter_frame({Type::kRead, data, answer.host}, answer.index,
                         answer.refused ? 0 : answer.raw);
}

bool decode_parameter_answer(const CanFrame& frame, ParameterAnswer* answer) noexcept {
  Id id{};
  if (!split(frame, &id) || id.type != Type::kRead || id.target <= kLastMotor) return false;
  *answer = {static_cast<std::uint8_t>(id.data), id.target, id.data >> 8U != 0, index_of(frame),
             get_little(frame, 4)};
  return true;
}

CanFrame encode_fault(std::uint8_t motor, std::uint8_t host, const FaultReport& report) noexcept {
  CanFrame frame = frame_of({Type::kFault, motor, host});
  put_little(&frame, 0, report.faults);
  put_little(&frame, 4, report.warnings);
  return frame;
}

bool decode_fault(const CanFrame& frame, FaultReport* report) noexcept {
  Id id{};
  if (!split(frame, &id) || id.type != Type::kFault) return false;
  *report = {get_little(frame, 0), get_little(frame, 4)};
  return true;
}

}  // namespace limber::robstride
