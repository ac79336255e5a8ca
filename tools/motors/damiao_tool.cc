#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "drivers/protocols/mit.h"
#include "tools/can/damiao_decoder.h"
#include "tools/motors/registers.h"

namespace limber::motor_tools {
namespace {

constexpr std::uint8_t kDamiaoReplyId = 7;
constexpr std::uint8_t kDamiaoNumber = 8;
constexpr std::uint8_t kDamiaoPosition = 81;  // behind the gear
constexpr std::uint8_t kDamiaoFirstMeasured = 80;
constexpr std::uint8_t kDamiaoModel[] = {16, 20};  // pole pairs, gear ratio
constexpr std::uint8_t kDamiaoWritable[] = {0,  2,  3,  4,  5,  6,  9,  10, 21, 22, 23,
                                            24, 25, 26, 27, 28, 29, 31, 32, 33, 34};
constexpr std::pair<std::uint8_t, const char*> kDamiaoRobotKeys[] = {
    {kDamiaoReplyId, "joints.*.reply_id"},
    {20, "motors.*.gear_ratio"},
    {21, "motors.*.mit_range.position_rad"},
    {22, "motors.*.mit_range.velocity_rad_per_s"},
    {23, "motors.*.mit_range.torque_Nm"}};
constexpr std::uint8_t kDamiaoBitRate = 35;
constexpr BitRate kDamiaoBitRates[] = {
    {125'000, 0},   {200'000, 1},   {250'000, 2},   {500'000, 3},   {1'000'000, 4},
    {2'000'000, 5}, {2'500'000, 6}, {3'200'000, 7}, {4'000'000, 8}, {5'000'000, 9}};
constexpr int kDamiaoBits = 12;         // of velocity and torque in a state
constexpr double kDamiaoStore_s = 0.1;  // flash takes some time

mit::Register as_register(std::uint32_t number) { return static_cast<mit::Register>(number); }
std::uint16_t as_id(int number) { return static_cast<std::uint16_t>(number); }

std::vector<StoredRegister> damiao_stored() {
  std::vector<StoredRegister> stored;
  for (const bus_tools::DamiaoRegister& row : bus_tools::damiao_registers()) {
    if (row.number >= kDamiaoFirstMeasured) continue;
    const bool writable = std::ranges::count(kDamiaoWritable, row.number) > 0;
    const bool model = std::ranges::count(kDamiaoModel, row.number) > 0;
    const std::string unit = *row.unit == '\0' ? "" : fmt::format(" ({})", row.unit);
    stored.push_back({row.number, row.name + unit, row.whole ? Format::kUint32 : Format::kFloat,
                      writable ? Setting::Use::kWritable
                      : model  ? Setting::Use::kModel
                               : Setting::Use::kOther});
    for (const auto& [reg, key] : kDamiaoRobotKeys)
      if (reg == row.number) stored.back().robot_key = key;
  }
  return stored;
}

class DamiaoTool final : public RegisterTool {
 public:
  std::string_view protocol() const noexcept override { return "damiao_mit"; }
  int last_number() const noexcept override { return 127; }

  CanFrame presence(int number, bool fd) const noexcept override {
    return mit::encode_register_read(as_id(number), as_register(kDamiaoReplyId), fd);
  }
  std::optional<Found> found(const CanFrame& frame) const override {
    if (frame.extended || frame.length != 8) return std::nullopt;
    const int number = frame.data[0] | frame.data[1] << 8;
    std::uint32_t reply = 0;
    if (!mit::decode_register(frame, as_id(number), mit::kReadRegister, as_register(kDamiaoReplyId),
                              &reply))
      return std::nullopt;
    return Found{number, fmt::format("replies as 0x{:X}", frame.id)};
  }

  Measured measure(Wire* wire, int number, bool fd) const override {
    const auto stored = [&](mit::Register reg) {
      return read_float(wire, number, static_cast<std::uint32_t>(reg), fd);
    };
    CommandRange range;
    range.position_rad = stored(mit::Register::kPositionRange);
    range.velocity_rad_per_s = stored(mit::Register::kVelocityRange);
    range.torque_Nm = stored(mit::Register::kTorqueRange);
    const mit::Reply reply = state(wire, number, fd, range);
    return {.angle_rad = read_float(wire, number, kDamiaoPosition, fd),
            .velocity_rad_per_s =
                reply.velocity_rad_per_s + mit::half_count(range.velocity_rad_per_s, kDamiaoBits),
            .torque_Nm = reply.torque_Nm + mit::half_count(range.torque_Nm, kDamiaoBits),
            .temperature_degC = static_cast<double>(
                std::max(reply.mos_temperature_degC, reply.rotor_temperature_degC)),
            .state = state_text(reply.error)};
  }

  std::string_view not_read() const noexcept override {
    return "no register names the model: pole pairs and gear ratio stand for it";
  }

  bool store(Wire* wire, int number, bool fd) const override {
    wire->send(mit::encode_register_store(as_id(number), fd), kDamiaoStore_s,
               [](const CanFrame&) {});
    return true;
  }

  bool enabled(Wire* wire, int number, bool fd) const override {
    return state(wire, number, fd).error == mit::DriveError::kEnabled;
  }

  void set_number(Wire* wire, int number, int wanted, bool fd) const override {
    put(wire, number, kDamiaoNumber, static_cast<std::uint32_t>(wanted), fd);
    store(wire, wanted, fd);
    const std::uint32_t now = read(wire, wanted, kDamiaoNumber, fd);
    if (now != static_cast<std::uint32_t>(wanted))
      throw std::runtime_error(fmt::format("ESC_ID reads {}, not {}", now, wanted));
  }

  void set_zero(Wire* wire, int number, bool fd) const override {
    wire->send(mit::encode_special(mit::Special::kSetZero, as_id(number), fd), kDamiaoStore_s,
               [](const CanFrame&) {});
    require_zero(mit::bits_float(read(wire, number, kDamiaoPosition, fd)));
  }

  std::span<const BitRate> bit_rates() const noexcept override { return kDamiaoBitRates; }
  /// Some firmware has the new rate at once, and then stores it at that rate only. Source:
  /// jia-xie/python-damiao-driver, pull request 9.
  std::string set_bit_rate(Wire* wire, int number, const BitRate& rate, bool fd) const override {
    wire->send(
        mit::encode_register_write(as_id(number), as_register(kDamiaoBitRate), rate.code, fd),
        Wire::kAnswer_s, [](const CanFrame&) {});
    auto now = try_read(wire, number, kDamiaoBitRate, fd);
    if (!now)
      return "it has its new rate, not stored yet: bring the bus up at that rate and repeat this";
    if (*now == rate.code) {
      store(wire, number, fd);
      now = read(wire, number, kDamiaoBitRate, fd);
    }
    if (*now != rate.code)
      throw std::runtime_error(fmt::format(
          "can_br reads {}, not {}: some firmware takes it on a CAN-FD bus only", *now, rate.code));
    return "stored and read back; it counts at the latest when its supply was off";
  }

 private:
  const std::vector<StoredRegister>& stored() const override {
    static const std::vector<StoredRegister> kStored = damiao_stored();
    return kStored;
  }

  std::optional<std::uint32_t> try_read(Wire* wire, int number, std::uint32_t reg,
                                        bool fd) const override {
    std::uint32_t raw = 0;
    const auto mine = [&](const CanFrame& frame) {
      return !frame.extended && frame.id != mit::kRegisterId &&
             mit::decode_register(frame, as_id(number), mit::kReadRegister, as_register(reg), &raw);
    };
    if (!wire->ask(mit::encode_register_read(as_id(number), as_register(reg), fd), mine))
      return std::nullopt;
    return raw;
  }
  std::uint32_t read(Wire* wire, int number, std::uint32_t reg, bool fd) const {
    if (const auto raw = try_read(wire, number, reg, fd)) return *raw;
    throw std::runtime_error(fmt::format("register {} is not answered", reg));
  }

  void put(Wire* wire, int number, const StoredRegister& reg, std::uint32_t value,
           bool fd) const override {
    put(wire, number, reg.number, value, fd);
  }
  static void put(Wire* wire, int number, std::uint32_t reg, std::uint32_t value, bool fd) {
    std::uint32_t raw = 0;
    const auto mine = [&](const CanFrame& frame) {
      return frame.id != mit::kRegisterId &&
             mit::decode_register(frame, as_id(number), mit::kWriteRegister, as_register(reg),
                                  &raw);
    };
    if (!wire->ask(mit::encode_register_write(as_id(number), as_register(reg), value, fd), mine))
      throw std::runtime_error(fmt::format("writing register {} is not answered", reg));
    if (raw != value)
      throw std::runtime_error(
          fmt::format("register {} stays {}: the drive refused {}", reg, raw, value));
  }

  static std::string state_text(mit::DriveError error) {
    const std::string text = mit::error_text(error);
    return text.empty() ? fmt::format("{:X}", static_cast<int>(error)) : text;
  }

  static mit::Reply state(Wire* wire, int number, bool fd, const CommandRange& range = {}) {
    mit::Reply reply;
    const auto mine = [&](const CanFrame& frame) {
      std::uint32_t raw = 0;
      return !frame.extended && frame.id != mit::kRegisterId &&
             !mit::decode_register(frame, as_id(number), mit::kReadRegister,
                                   as_register(kDamiaoPosition), &raw) &&
             mit::decode_reply(frame, range, &reply) && reply.id_nibble == (number & 0xF);
    };
    if (!wire->ask(mit::encode_state_request(as_id(number), fd), mine))
      throw std::runtime_error("its state is not answered");
    return reply;
  }
};

const DamiaoTool kDamiao;

}  // namespace

extern const MotorTool* const kDamiaoTool;
const MotorTool* const kDamiaoTool = &kDamiao;

}  // namespace limber::motor_tools
